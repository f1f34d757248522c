#pragma once

#include <optional>
#include <string>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/calibrate.hpp"
#include "forcebound/server/environment/stability.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"

namespace forcebound::server {

/// A hand that the scene is felt with, and what became of it.
struct ExplainedHand {
  SuggestedHand suggested;
  HandTrial trial;
};

/// What the scene alone does not know.
struct ExplainFacts {
  std::size_t answer_bytes = 0;                           ///< of the datagram that answers a motion in contact
  std::optional<Calibration> calibration = std::nullopt;  ///< none: the costs are predictions alone
  RingingDevice device{};                                 ///< for the margins of stability
  std::optional<ExplainedHand> hand = std::nullopt;       ///< none: nothing is said of it
};

/// What will be simulated, and what will not, in lines for a person: for each object and field what is asked for, what
/// that implies, cost, memory and stability; for all of them the total against a tick of 1 ms.
std::string explain(const scene::Scene& scene, const ExplainFacts& facts = {});

/// The same in one line: "ball (sphere): surface stiffness_N_per_m 10000, damping_N_s_per_m 0".
std::string summary(const scene::Scene& scene);

}  // namespace forcebound::server
