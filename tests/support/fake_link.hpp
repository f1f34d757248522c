#pragma once

#include <algorithm>
#include <cstddef>
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
    if (!works) return false;
    if (keep) sent.push_back({{datagram.begin(), datagram.end()}, to});
    return true;
  }

  /// Neither allocates nor frees.
  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    if (received_ == arrived_.size()) return std::nullopt;
    const Datagram& datagram = arrived_[received_++];
    std::copy_n(datagram.bytes.begin(), std::min(buffer.size(), datagram.bytes.size()), buffer.begin());
    return net::Received{datagram.bytes.size(), datagram.peer};
  }

  void arrive(std::span<const std::byte> datagram, const net::Address& from) {
    arrived_.push_back({{datagram.begin(), datagram.end()}, from});
  }

  std::vector<Datagram> sent;
  bool works = true;
  bool keep = true;  ///< false: a link that does not allocate

 private:
  std::vector<Datagram> arrived_;
  std::size_t received_ = 0;
};

}  // namespace forcebound::test
