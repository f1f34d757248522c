#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::tests {

/// A network that keeps what was sent for the test to look at, and delivers nothing.
class FakeLink final : public net::DatagramLink {
 public:
  struct Sent {
    std::vector<std::byte> bytes;
    net::Address to;
  };

  bool send(std::span<const std::byte> datagram, const net::Address& to) noexcept override {
    if (!works) return false;
    if (keep) sent.push_back({{datagram.begin(), datagram.end()}, to});
    return true;
  }

  std::optional<net::Received> receive(std::span<std::byte>) noexcept override { return std::nullopt; }

  bool works = true;
  bool keep = true;  ///< false: a link that does not allocate
  std::vector<Sent> sent;
};

/// A clock that stands where the test puts it.
class FakeClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time; }

  time::Nanoseconds time{0};
};

}  // namespace forcebound::tests
