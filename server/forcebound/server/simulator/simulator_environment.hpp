#pragma once

#include <memory>
#include <string>

#include "forcebound/server/offer/environment.hpp"
#include "forcebound/server/simulator/simulator.hpp"

namespace forcebound::server {

/// How a simulator is offered to clients: its name, and what it is in one line.
struct SimulatorOffer {
  std::string name{};
  std::string simulated{};
};

/// A simulator that steps at its own rate, as an environment of all clients: their probes go on at the clients' rates
/// between its reports, and clients that render locally are told what they meet.
///
/// Without a report for 250 ms the force fades, and is zero after a second, as that of a late server; a report brings
/// it back in a twentieth of a second. Until the first one nothing is felt.
EnvironmentKind simulator_environment(const SimulatorOffer& offer, const std::shared_ptr<Simulator>& simulator);

}  // namespace forcebound::server
