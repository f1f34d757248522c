#pragma once

#include <readerwriterqueue/readerwriterqueue.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/tick_record.hpp"

namespace forcebound::record {

/// Carries records from a thread that must never wait to one that writes them to disk.
///
/// A bounded lock-free queue in between: full, a record is counted and gone. One thread calls the `on_` functions, one
/// other thread `drain`, say every 100 ms.
///
/// Real time: the `on_` functions are noexcept, allocate nothing and never wait.
class Recorder final : public TickSink {
 public:
  /// About 8 s of a client's ticks and forces, in 6 MB: so long a disk may hesitate.
  static constexpr std::size_t kCapacity = 16384;

  explicit Recorder(std::size_t capacity = kCapacity) : queue_(capacity) {}

  void on_tick(const TickRecord& tick) noexcept override { push(tick); }
  void on_force(const ForceRecord& force) noexcept override { push(force); }

  /// The server's side of the same: motion as it arrived, force as it was sent.
  void on_motion(const MotionRecord& motion) noexcept { push(motion); }
  void on_sent(const SentForceRecord& force) noexcept { push(force); }

  /// Writes all that waits, in the order in which it came; returns how many.
  std::size_t drain(RecordingWriter& writer);

  /// Records that found the queue full. Any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  using Item = std::variant<TickRecord, ForceRecord, MotionRecord, SentForceRecord>;

  template <class Record>
  void push(const Record& record) noexcept {
    if (!queue_.try_enqueue(Item(record))) dropped_.fetch_add(1, std::memory_order_relaxed);
  }

  moodycamel::ReaderWriterQueue<Item> queue_;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace forcebound::record
