#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::test {

/// A link whose other end is the test: it reads what was sent and puts in what shall arrive.
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
    return net::Received{datagram.bytes.size(), datagram.peer, waited};
  }

  void arrive(std::span<const std::byte> datagram, const net::Address& from) {
    arrived_.push_back({{datagram.begin(), datagram.end()}, from});
  }

  /// Reserves room for that many arrivals, so that no later one touches the heap.
  void reserve(std::size_t datagrams) {
    prepared_.assign(datagrams, {std::vector<std::byte>(net::kDatagramBytesMax), {}});
    arrived_.reserve(arrived_.size() + datagrams);
  }
  void arrive_again(std::span<const std::byte> datagram, const net::Address& from) {
    Datagram waiting = std::move(prepared_.back());
    prepared_.pop_back();
    waiting.bytes.assign(datagram.begin(), datagram.end());
    waiting.peer = from;
    arrived_.push_back(std::move(waiting));
  }

  std::vector<Datagram> sent;
  time::Nanoseconds waited{0};  ///< of datagrams received from now on
  bool works = true;
  bool keep = true;  ///< false: a link that does not allocate

 private:
  std::vector<Datagram> prepared_;
  std::vector<Datagram> arrived_;
  std::size_t received_ = 0;
};

}  // namespace forcebound::test
