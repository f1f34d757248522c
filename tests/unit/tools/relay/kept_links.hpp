#pragma once

#include <algorithm>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/tools/relay/relay.hpp"

namespace forcebound::relay {

inline std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

inline Address at(std::uint16_t port) { return {.port = port}; }

inline constexpr std::uint16_t kServerPort = 9000;

/// One end of a network without a network: what was put in is received, what was sent is kept.
class KeptLink final : public net::DatagramLink {
 public:
  bool send(std::span<const std::byte> datagram, const Address& to) noexcept override {
    if (broken) return false;
    sent.emplace_back(to.port, std::string(reinterpret_cast<const char*>(datagram.data()), datagram.size()));
    return true;
  }
  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    if (waiting.empty()) return std::nullopt;
    const auto [port, text] = waiting.front();
    waiting.pop_front();
    std::copy_n(bytes_of(text).begin(), std::min(text.size(), buffer.size()), buffer.begin());
    return net::Received{text.size(), at(port)};
  }

  std::deque<std::pair<std::uint16_t, std::string>> waiting;
  std::vector<std::pair<std::uint16_t, std::string>> sent;
  bool broken = false;
};

class KeptUpstream final : public UpstreamLinks {
 public:
  net::DatagramLink* open() override {
    if (exhausted) return nullptr;
    return links.emplace_back(std::make_unique<KeptLink>()).get();
  }
  void close(net::DatagramLink& link) override {
    std::erase_if(links, [&](const auto& own) { return own.get() == &link; });
  }
  std::vector<std::unique_ptr<KeptLink>> links;
  bool exhausted = false;
};

}  // namespace forcebound::relay
