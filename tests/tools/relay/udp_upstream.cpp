#include "tests/tools/relay/udp_upstream.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

namespace forcebound::relay {

net::DatagramLink* UdpUpstream::open() try {
  auto link = std::make_unique<net::UdpLink>(net::UdpLink::towards(server_));
  descriptors_.push_back(link->descriptor());
  return links_.emplace_back(std::move(link)).get();
} catch (const std::runtime_error& error) {
  // Once: a client without a socket causes this error with every datagram.
  if (!std::exchange(failure_reported_, true)) spdlog::error("no socket for another client: {}", error.what());
  return nullptr;
}

void UdpUpstream::close(net::DatagramLink& link) {
  const auto found = std::find_if(links_.begin(), links_.end(), [&](const auto& own) { return own.get() == &link; });
  refused_of_closed_ += (*found)->counters().refused;
  descriptors_.erase(descriptors_.begin() + (found - links_.begin()));
  links_.erase(found);
}

std::uint64_t UdpUpstream::refused() const noexcept {
  std::uint64_t sum = refused_of_closed_;
  for (const auto& link : links_) sum += link->counters().refused;
  return sum;
}

}  // namespace forcebound::relay
