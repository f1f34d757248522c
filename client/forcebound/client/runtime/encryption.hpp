#pragma once

#include <stop_token>
#include <string>
#include <thread>

#include "forcebound/client/security/handshaker.hpp"
#include "forcebound/client/security/identity_files.hpp"
#include "forcebound/client/security/secure_link.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// A client's encrypted way to its server: a link in front of another, with a thread of its own for handshakes, which
/// runs from the beginning. `link` is for the one thread that ticks; its thread sleeps but for a handshake.
class Encryption {
 public:
  /// @param server_name HOST:PORT as the user wrote it
  /// @param server its address, as `link` has it
  /// Link and clock must outlive it. @throws what `read_identity` does
  Encryption(const IdentityFiles& files, const std::string& server_name, net::DatagramLink& link,
             const net::Address& server, const time::Clock& clock);
  Encryption(const Encryption&) = delete;
  Encryption& operator=(const Encryption&) = delete;

  [[nodiscard]] SecureLink& link() noexcept { return link_; }
  [[nodiscard]] Handshaker& handshaker() noexcept { return handshaker_; }

 private:
  void work(const std::stop_token& ended);

  const time::Clock& clock_;
  Handshaker handshaker_;
  SecureLink link_;
  std::jthread thread_;
};

}  // namespace forcebound::client
