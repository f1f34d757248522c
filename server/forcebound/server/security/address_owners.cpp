#include "forcebound/server/security/address_owners.hpp"

#include <utility>

#include "forcebound/control/assertion.hpp"

namespace forcebound::server {
namespace {

// SplitMix64's finaliser [Steele, Lea and Flood 2014].
std::uint64_t mixed_address_word(std::uint64_t x) noexcept {
  x = (x ^ x >> 30U) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ x >> 27U) * 0x94d049bb133111ebULL;
  return x ^ x >> 31U;
}

}  // namespace

std::optional<net::Address> RecentAddresses::add(const net::Address& from) noexcept {
  if (newest_[0] == from) return std::nullopt;
  const std::optional<net::Address> left = newest_[1] == from ? std::nullopt : newest_[1];
  newest_[1] = newest_[0];
  newest_[0] = from;
  return left;
}

std::size_t AddressOwners::Hash::operator()(const net::Address& address) const noexcept {
  constexpr std::size_t kWordBytes = 8;
  constexpr unsigned kByteBits = 8;
  std::uint64_t hash = key ^ address.port;
  for (std::size_t at = 0; at < address.ip.size(); at += kWordBytes) {
    std::uint64_t word = 0;
    for (std::size_t i = at; i < at + kWordBytes; ++i) word = word << kByteBits | address.ip[i];
    hash = mixed_address_word(hash ^ word);
  }
  return static_cast<std::size_t>(mixed_address_word(hash ^ key));
}

AddressOwners::AddressOwners(std::size_t sessions, std::uint64_t key) : owners_(0, Hash{key}) {
  const std::size_t addresses = sessions * RecentAddresses::kKept;
  owners_.reserve(addresses);
  unused_.reserve(addresses);
  while (unused_.size() < addresses) {
    owners_.emplace(net::Address{}, 0U);
    unused_.push_back(owners_.extract(net::Address{}));
  }
}

std::optional<std::uint32_t> AddressOwners::find(const net::Address& address) const noexcept {
  const auto found = owners_.find(address);
  return found == owners_.end() ? std::nullopt : std::optional(found->second);
}

void AddressOwners::assign(std::uint32_t session, RecentAddresses& places, const net::Address& from) noexcept {
  if (const auto left = places.add(from)) release(session, *left);
  if (const auto found = owners_.find(from); found != owners_.end()) {
    found->second = session;
    return;
  }
  // Each session owns no more addresses than it keeps, so that there is always one left.
  FORCEBOUND_ASSERT(!unused_.empty(), "more sessions have addresses than there may be");
  Owners::node_type node = std::move(unused_.back());
  unused_.pop_back();
  node.key() = from;
  node.mapped() = session;
  owners_.insert(std::move(node));
}

void AddressOwners::forget(std::uint32_t session, const RecentAddresses& places) noexcept {
  for (const auto& address : places.all()) {
    if (address) release(session, *address);
  }
}

void AddressOwners::release(std::uint32_t session, const net::Address& address) noexcept {
  const auto found = owners_.find(address);
  if (found == owners_.end() || found->second != session) return;  // by now it is another one's
  unused_.push_back(owners_.extract(found));
}

}  // namespace forcebound::server
