#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "forcebound/net/name_lookup.hpp"
#include "forcebound/net/peer_link.hpp"
#include "forcebound/page/request.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// The impairments of a network in netem's words, for both directions: "both delay 50ms 10ms loss 5%".
[[nodiscard]] std::string relay_line(const page::Network& network);

/// The same for people: "delay 50ms 10ms loss 5%" or "perfect".
[[nodiscard]] std::string words_of_network(const page::Network& network);

/// Reads a relay's answer, "up: delay 50ms; down: perfect": the impairments from client to server, as far as they are
/// delay, jitter and loss. Nothing: it is none.
[[nodiscard]] std::optional<page::Network> network_of(std::string_view answer);

/// Tells a forcebound-relay with --control what network to emulate. Each call waits for the answer, a second at most;
/// meanwhile it asks again, each address of a name by turns, which is looked up again where none answers.
class RelayControl {
 public:
  /// @throws std::invalid_argument for what is no HOST:PORT; std::runtime_error if there is no way to it. A name
  /// without an address is no reason: it may have one later.
  /// @param clock must outlive it
  RelayControl(const std::string& address, const time::Clock& clock, net::Resolver resolver = net::look_up);

  /// The network that is emulated now. @throws std::runtime_error naming the relay if it does not answer as one
  [[nodiscard]] page::Network network();

  /// @throws std::runtime_error likewise, or what the relay says against it
  page::Network set(const page::Network& network);

 private:
  page::Network ask(const std::string& line);

  net::NameLookup lookup_;
  net::PeerLink link_;
};

}  // namespace forcebound::client
