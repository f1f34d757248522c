#pragma once

#include <memory>
#include <string>
#include <vector>

#include "forcebound/client/commands/doctor/doctor_session.hpp"
#include "forcebound/client/runtime/encryption.hpp"
#include "forcebound/client/security/identity_files.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_link.hpp"

namespace forcebound::client::commands {

/// The server that is examined.
struct ExaminedServer {
  std::string name;                       ///< HOST:PORT
  client::IdentityFiles identity{};       ///< keys; none: not encrypted
  net::Resolver resolver = net::look_up;  ///< finds the addresses of the name
};

/// A link to an address of the server, and a session on it.
struct DoctorLine {
  /// @param settings `server` is the address
  /// @throws std::runtime_error if there is no way there
  DoctorLine(const ExaminedServer& server, const DoctorSession::Settings& settings, const time::Clock& clock);

  net::Address address;
  net::UdpLink link;
  std::unique_ptr<client::Encryption> encryption;
  DoctorSession session;
};

/// Sleeps for the link's datagrams.
void wait_for_datagrams(const net::UdpLink& link, Nanoseconds duration);

/// Whether the line has a session within the patience for one: 5 s.
[[nodiscard]] bool introduce(DoctorLine& line, const time::Clock& clock);

/// The first line with a session, or that was refused one, of all addresses of the server's name: each is tried beside
/// those before it, 250 ms after them or as soon as nobody is there [RFC 8305, section 5]. A name without an address is
/// looked up again, within the same 5 s.
///
/// @param settings `server` is left out
/// @throws std::runtime_error naming the server and its addresses if none of them answers
[[nodiscard]] std::unique_ptr<DoctorLine> first_to_answer(const ExaminedServer& server,
                                                          const DoctorSession::Settings& settings,
                                                          const time::Clock& clock);

/// The server's name, and the address at which it was found.
[[nodiscard]] std::string in_words(const ExaminedServer& server, const net::Address& found);

}  // namespace forcebound::client::commands
