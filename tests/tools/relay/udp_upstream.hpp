#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/net/name_lookup.hpp"
#include "forcebound/net/peer_link.hpp"
#include "tests/tools/relay/relay.hpp"

namespace forcebound::relay {

/// One UDP socket towards the server for each client.
class UdpUpstream final : public UpstreamLinks {
 public:
  /// Finds the server for each client by itself; the lookup must outlive it.
  UdpUpstream(net::NameLookup& server, const time::Clock& clock) : server_(server), clock_(clock) {}

  net::DatagramLink* open() override;
  void close(net::DatagramLink& link) override;

  /// Of all open sockets, for waiting.
  [[nodiscard]] const std::vector<int>& descriptors() const noexcept { return descriptors_; }

  /// Raises the process's limit on open files, where it is lower, so that there can be a socket for so many clients.
  /// @returns for how many there can be now, as far as that limit goes
  [[nodiscard]] static std::size_t make_room(std::size_t clients) noexcept;

  /// Where the server was found, one line for each change.
  [[nodiscard]] std::vector<std::string> take_news();

  /// Datagrams refused by the server's machine with port unreachable (ICMP).
  [[nodiscard]] std::uint64_t refused() const noexcept;

 private:
  net::NameLookup& server_;
  const time::Clock& clock_;
  std::vector<std::unique_ptr<net::PeerLink>> links_;
  std::vector<int> descriptors_;  // as links_
  std::uint64_t refused_of_closed_ = 0;
  bool failure_reported_ = false;
  std::string reported_{};
};

}  // namespace forcebound::relay
