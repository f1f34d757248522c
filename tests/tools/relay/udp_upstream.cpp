#include "tests/tools/relay/udp_upstream.hpp"

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace forcebound::relay {

net::DatagramLink* UdpUpstream::open() try {
  auto link = std::make_unique<net::PeerLink>(server_, clock_, net::PeerLink::Found::by_answer);
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

std::size_t UdpUpstream::make_room(std::size_t clients) noexcept {
  // Standard input and the like, the socket of the clients, the log, and what the libraries open.
  constexpr ::rlim_t kOthers = 32;
  ::rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return clients;
  const ::rlim_t wanted = clients + kOthers;
  if (files.rlim_cur != RLIM_INFINITY && files.rlim_cur < wanted) {
    const ::rlimit raised{.rlim_cur = std::min(wanted, files.rlim_max), .rlim_max = files.rlim_max};
    if (::setrlimit(RLIMIT_NOFILE, &raised) == 0) files = raised;
  }
  if (files.rlim_cur == RLIM_INFINITY || files.rlim_cur >= wanted) return clients;
  return files.rlim_cur > kOthers ? static_cast<std::size_t>(files.rlim_cur - kOthers) : 1;
}

std::vector<std::string> UdpUpstream::take_news() {
  std::vector<std::string> all;
  for (const auto& link : links_) {
    // Each client finds it; what all of them find is said once.
    if (std::string found = link->take_news(); !found.empty() && found != reported_)
      all.push_back(reported_ = std::move(found));
  }
  return all;
}

std::uint64_t UdpUpstream::refused() const noexcept {
  std::uint64_t sum = refused_of_closed_;
  for (const auto& link : links_) sum += link->counters().refused;
  return sum;
}

}  // namespace forcebound::relay
