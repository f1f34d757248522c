#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::test {

/// A link whose other end is the test: what was sent can be read, what shall arrive can be put in.
class FakeLink final : public net::DatagramLink {
 public:
  struct Datagram {
    std::vector<std::byte> bytes;
    net::Address peer;
  };

  bool send(std::span<const std::byte> datagram, const net::Address& to) noexcept override {
    if (!up) return false;
    sent.push_back({{datagram.begin(), datagram.end()}, to});
    return true;
  }

  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    if (waiting.empty()) return std::nullopt;
    const Datagram datagram = std::move(waiting.front());
    waiting.pop_front();
    std::copy_n(datagram.bytes.begin(), std::min(buffer.size(), datagram.bytes.size()), buffer.begin());
    return net::Received{datagram.bytes.size(), datagram.peer};
  }

  void arrive(std::span<const std::byte> datagram, const net::Address& from) {
    waiting.push_back({{datagram.begin(), datagram.end()}, from});
  }

  std::vector<Datagram> sent;
  std::deque<Datagram> waiting;
  bool up = true;
};

}  // namespace forcebound::test
