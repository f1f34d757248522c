#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "forcebound/net/udp_link.hpp"

namespace forcebound::lab {

/// Datagrams of the same size to the same address, cut apart by the system from one piece (UDP_SEGMENT): so that one
/// core loads a server more than another can bear.
class Burst {
 public:
  static constexpr std::size_t kDatagramsMax = 32;

  /// False if it does not go with those that are there: full, or of another size.
  [[nodiscard]] bool take(std::span<const std::byte> datagram) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// Sends all; false if the system did not take them. Empty afterwards.
  bool send(net::UdpLink& link, const net::Address& to) noexcept;

 private:
  std::array<std::byte, kDatagramsMax * net::kDatagramBytesMax> bytes_;
  std::size_t each_bytes_ = 0;
  std::size_t count_ = 0;
};

}  // namespace forcebound::lab
