#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace forcebound::server {

/// Where those sessions of keys are that are not with the worker that their number tells, for all workers of a process
/// (shared_limits.hpp): the system sends their records to that one, which hands them on by this.
///
/// Who has the keys is in here alone: whoever moves or forgets them says so, and nothing else keeps an entry.
///
/// Thread-safe; a look-up waits for no more than another's look-up or change. While none has moved it costs a read of
/// an atomic.
class MovedKeys {
 public:
  /// @param most at once: each worker has room for so many beside its own
  MovedKeys(std::size_t most, std::size_t workers);

  [[nodiscard]] std::optional<std::size_t> worker_of(std::uint32_t keys) const noexcept;

  /// They are at this worker from now on; at that of their number: no longer moved. False: there are too many.
  [[nodiscard]] bool note(std::uint32_t keys, std::size_t worker) noexcept;

  /// Nobody has them any more.
  void forget(std::uint32_t keys) noexcept;

  /// Of those that its numbers are, how many are with others.
  [[nodiscard]] std::size_t away_from(std::size_t worker) const noexcept;

  [[nodiscard]] std::size_t most() const noexcept { return most_; }

 private:
  const std::size_t most_;
  const std::size_t workers_;
  mutable std::mutex guard_;
  std::unordered_map<std::uint32_t, std::size_t> workers_of_;
  std::atomic<std::size_t> count_{0};
};

}  // namespace forcebound::server
