#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "forcebound/security/keys.hpp"

namespace forcebound::server {

/// Where those sessions of keys are that are not with the worker that their number tells, for all workers of a process
/// (shared_limits.hpp): the system sends their records to that one, which hands them on by this.
///
/// Who has the keys is in here alone: whoever moves or forgets them says so, and nothing else keeps an entry. No client
/// can take all places: it gets another while as many stay free as it has.
///
/// Thread-safe, and allocates nothing; a look-up waits for no more than another's look-up or change. While none has
/// moved it costs a read of an atomic.
class MovedKeys {
 public:
  /// @param most at once: each worker has room for so many beside its own
  MovedKeys(std::size_t most, std::size_t workers);

  [[nodiscard]] std::optional<std::size_t> worker_of(std::uint32_t keys) const noexcept;

  /// They are at this worker from now on; at that of their number: no longer moved. False: there are too many, of all
  /// or of this client.
  /// @param client whose they are; null: no client is known from another
  [[nodiscard]] bool store(std::uint32_t keys, std::size_t worker,
                           const security::PublicKey* client = nullptr) noexcept;

  /// Nobody has them any more.
  void forget(std::uint32_t keys) noexcept;

  /// How many are not with the worker of their number.
  [[nodiscard]] std::size_t count() const noexcept { return count_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t most() const noexcept { return most_; }

 private:
  struct Entry {
    std::size_t worker = 0;
    std::optional<security::PublicKey> client{};
  };
  using Moved = std::unordered_map<std::uint32_t, Entry>;
  void remove(std::uint32_t keys) noexcept;
  [[nodiscard]] bool may_add(const security::PublicKey* client) const noexcept;

  const std::size_t most_;
  const std::size_t workers_;
  mutable std::mutex guard_;
  Moved moved_;
  std::vector<Moved::node_type> unused_;  ///< so that nothing that moves needs memory
  std::atomic<std::size_t> count_{0};
};

}  // namespace forcebound::server
