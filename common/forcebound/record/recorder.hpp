#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/tick_record.hpp"

namespace forcebound::record {

/// Carries records from a thread that must never wait to one that writes them to disk or to viewers.
///
/// Between them is a bounded lock-free queue; when it is full, a record is dropped and counted. One thread calls the
/// `on_` functions, one other thread `drain`, for example every 100 ms.
///
/// Real time: the `on_` functions are noexcept, allocate nothing and never wait.
class Recorder final : public TickSink {
 public:
  /// About 8 s of a client's ticks and forces, in 29 MB: the longest pause of a disk without loss.
  static constexpr std::size_t kCapacity = 16384;

  explicit Recorder(std::size_t capacity = kCapacity);
  ~Recorder() override;

  void on_tick(const TickRecord& tick) noexcept override;
  void on_force(const ForceRecord& force) noexcept override;

  /// The same at the server: motion as it arrived, force as it was sent.
  void on_motion(const MotionRecord& motion) noexcept;
  void on_sent(const SentForceRecord& force) noexcept;

  /// Writes all waiting records, in order; returns their number.
  std::size_t drain(TopicEncoder& encoder);
  std::size_t drain(RecordingWriter& writer) { return drain(writer.encoder()); }

  /// Records that found the queue full. Any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  struct Queue;

  template <class Record>
  void push(const Record& record) noexcept;

  std::unique_ptr<Queue> queue_;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace forcebound::record
