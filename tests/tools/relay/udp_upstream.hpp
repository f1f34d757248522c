#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "forcebound/net/udp_link.hpp"
#include "tests/tools/relay/relay.hpp"

namespace forcebound::relay {

/// One UDP socket towards the server for each client.
class UdpUpstream final : public UpstreamLinks {
 public:
  explicit UdpUpstream(const Address& server) : server_(server) {}

  net::DatagramLink* open() override;
  void close(net::DatagramLink& link) override;

  /// Of all open sockets, for waiting.
  [[nodiscard]] const std::vector<int>& descriptors() const noexcept { return descriptors_; }

  /// Raises the process's limit on open files, where it is lower, so that there can be a socket for so many clients.
  /// @returns for how many there can be now, as far as that limit goes
  [[nodiscard]] static std::size_t make_room(std::size_t clients) noexcept;

  /// Datagrams refused by the server's machine with port unreachable (ICMP).
  [[nodiscard]] std::uint64_t refused() const noexcept;

 private:
  Address server_;
  std::vector<std::unique_ptr<net::UdpLink>> links_;
  std::vector<int> descriptors_;  // as links_
  std::uint64_t refused_of_closed_ = 0;
  bool failure_reported_ = false;
};

}  // namespace forcebound::relay
