#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::server {

/// Where one end of a session was heard from: its newest two addresses, the newest first.
class RecentAddresses {
 public:
  static constexpr std::size_t kKept = 2;

  [[nodiscard]] const std::array<std::optional<net::Address>, kKept>& all() const noexcept { return newest_; }

  /// @return the one that is no longer kept
  std::optional<net::Address> add(const net::Address& from) noexcept;

 private:
  std::array<std::optional<net::Address>, kKept> newest_{};
};

/// By which session of keys is sealed what goes to an address: by that of which the newest record came from there.
///
/// Real time: `find` and `assign` are noexcept, allocate nothing, O(1). Not thread-safe.
class AddressOwners {
 public:
  /// @param sessions at most so many have addresses at once
  /// @param key random: nobody can choose addresses that are slow to find
  AddressOwners(std::size_t sessions, std::uint64_t key);

  [[nodiscard]] std::optional<std::uint32_t> find(const net::Address& address) const noexcept;

  /// A record of this session came from there.
  void assign(std::uint32_t session, RecentAddresses& places, const net::Address& from) noexcept;

  /// The session is no more.
  void forget(std::uint32_t session, const RecentAddresses& places) noexcept;

 private:
  struct Hash {
    std::uint64_t key = 0;
    [[nodiscard]] std::size_t operator()(const net::Address& address) const noexcept;
  };
  using Owners = std::unordered_map<net::Address, std::uint32_t, Hash>;

  void release(std::uint32_t session, const net::Address& address) noexcept;

  Owners owners_;
  std::vector<Owners::node_type> unused_;  ///< so that no new address needs memory
};

}  // namespace forcebound::server
