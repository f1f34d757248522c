#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "forcebound/record/recorder.hpp"

namespace forcebound::live {

/// Carries records to the thread of a page while somebody there wants them. A full queue drops them and counts.
///
/// Real time: the `on_` functions are noexcept, allocate nothing and never wait; while nobody wants records they read
/// one flag. One thread at a time calls them, one other thread `drain`.
class RecordTap {
 public:
  /// Of a client's ticks and forces about 1 s, in 3.7 MB.
  static constexpr std::size_t kCapacity = 2048;

  void on_tick(const record::TickRecord& tick) noexcept {
    if (wanted()) recorder_.on_tick(tick);
  }
  void on_force(const record::ForceRecord& force) noexcept {
    if (wanted()) recorder_.on_force(force);
  }
  void on_motion(const record::MotionRecord& motion) noexcept {
    if (wanted()) recorder_.on_motion(motion);
  }
  void on_sent(const record::SentForceRecord& force) noexcept {
    if (wanted()) recorder_.on_sent(force);
  }

  /// Any thread.
  [[nodiscard]] bool wanted() const noexcept { return wanted_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return recorder_.dropped(); }

  /// Hands over what waits, and has more brought, or not.
  void drain(record::TopicEncoder& to, bool wanted) {
    wanted_.store(wanted, std::memory_order_relaxed);
    recorder_.drain(to);
  }

 private:
  record::Recorder recorder_{kCapacity};
  std::atomic<bool> wanted_{false};
};

}  // namespace forcebound::live
