#pragma once

#include <functional>
#include <string>

#include "forcebound/client/commands/doctor/findings.hpp"
#include "forcebound/client/commands/doctor/introduction.hpp"

namespace forcebound::client::commands {

struct ExaminationSettings {
  ExaminedServer server{};
  std::string scene{};  ///< requested; empty: the server's default
  double seconds = 5;   ///< of the measurement
};

/// Examines the way to a server and this machine, over real sockets and in real time: asks for a session as a client
/// does, sends a motion on each tick of 1 ms from a real-time thread beside one that only sleeps, ends that session,
/// and tries in another one how large datagrams may be. The hand rests at the origin.
///
/// Asks for the degrees of freedom of the scene in turn, until the server accepts.
///
/// @param progress is told the share done and what is being done
/// @throws std::runtime_error if the server's address cannot be found within 5 s, or if it does not answer, refuses, or
/// opens a session and sends no force
[[nodiscard]] DoctorFindings examine(const ExaminationSettings& settings,
                                     const std::function<void(double, const std::string&)>& progress);

}  // namespace forcebound::client::commands
