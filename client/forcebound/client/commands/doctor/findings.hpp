#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "forcebound/client/commands/doctor/doctor_session.hpp"
#include "forcebound/client/commands/doctor/machine_findings.hpp"
#include "forcebound/client/commands/doctor/network_findings.hpp"

namespace forcebound::client::commands {

/// What sizes of datagrams a network carries.
struct PathFindings {
  std::size_t up_bytes = 0;       ///< payload of the largest that reached the server whole; 0: none did, or not tried
  bool up_tried = false;          ///< otherwise there was no second session to try it in
  std::size_t up_most_bytes = 0;  ///< the largest that was tried: the protocol's
  std::size_t down_bytes = 0;     ///< payload of the largest that came; whether whole, only the server's machine knows
  std::size_t header_bytes = 0;   ///< in front of each payload
  std::optional<std::size_t> mtu{};  ///< as this machine believes, of the way up
};

/// The offset of the two clocks.
struct OffsetFindings {
  bool known = false;
  double ahead_ms = 0;      ///< the server's clock less this machine's
  double uncertain_ms = 0;  ///< by as much it may be off
};

/// All that an examination found.
struct DoctorFindings {
  std::string server{};  ///< HOST:PORT as given, and of a name the address
  double seconds = 0;    ///< of the measurement
  int degrees_of_freedom = 0;
  Handshake handshake{};
  std::uint64_t pieces_received = 0;  ///< of the scene, copies included
  std::uint64_t piece_bytes = 0;
  std::uint64_t malformed = 0;    ///< datagrams that no message could be read from
  std::uint64_t overflowed = 0;   ///< datagrams that found this machine's socket full
  std::uint64_t unreachable = 0;  ///< port unreachable (ICMP) received
  NetworkFindings network{};
  OffsetFindings clocks{};
  PathFindings path{};
  MachineFindings machine{};
};

}  // namespace forcebound::client::commands
