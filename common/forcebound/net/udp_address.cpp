#include "forcebound/net/internal/udp_address.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>

namespace forcebound::net {
namespace {

template <class Value>
Value value_of(const cmsghdr& part) noexcept {
  Value value{};
  std::memcpy(&value, CMSG_DATA(&part), sizeof value);
  return value;
}

}  // namespace

asio::ip::udp::endpoint to_asio(const Address& address) noexcept {
  const asio::ip::address_v6 v6(address.ip);
  if (!v6.is_v4_mapped()) return {v6, address.port};
  const auto& ip = address.ip;
  return {asio::ip::address_v4({ip[12], ip[13], ip[14], ip[15]}), address.port};
}

Address from_asio(const asio::ip::udp::endpoint& endpoint) noexcept {
  Address result;
  result.port = endpoint.port();
  if (endpoint.address().is_v6()) {
    result.ip = endpoint.address().to_v6().to_bytes();
    return result;
  }
  const auto bytes = endpoint.address().to_v4().to_bytes();
  result.ip[10] = result.ip[11] = 0xff;
  std::copy(bytes.begin(), bytes.end(), result.ip.begin() + 12);
  return result;
}

time::Nanoseconds waited_of(msghdr& message, time::Nanoseconds wall_clock_now) noexcept {
  constexpr time::Nanoseconds kMost = std::chrono::seconds{10};  // more is a jump of the wall clock
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    const auto stamp = value_of<timespec>(*part);
    const auto arrival = std::chrono::seconds{stamp.tv_sec} + time::Nanoseconds{stamp.tv_nsec};
    return std::clamp(wall_clock_now - arrival, time::Nanoseconds{0}, kMost);
  }
  return time::Nanoseconds{0};
}

}  // namespace forcebound::net
