#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "forcebound/net/udp_link.hpp"

namespace forcebound::lab {

/// Datagrams of the same size to the same address, split by the system (UDP_SEGMENT): so that one core can overload a
/// server on another.
class Burst {
 public:
  static constexpr std::size_t kDatagramsMax = 32;

  /// False if the burst is full, or the size differs.
  [[nodiscard]] bool add(std::span<const std::byte> datagram) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// Sends all; false if the system did not take them. Empty afterwards.
  bool send(net::UdpLink& link, const net::Address& to) noexcept;

 private:
  std::array<std::byte, kDatagramsMax * net::kDatagramBytesMax> bytes_;
  std::size_t each_bytes_ = 0;
  std::size_t count_ = 0;
};

}  // namespace forcebound::lab
