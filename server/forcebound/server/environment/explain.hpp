#pragma once

#include <optional>
#include <string>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/calibrate.hpp"
#include "forcebound/server/environment/stability.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"

namespace forcebound::server {

/// A suggested hand for the scene, and the result of its trial.
struct ExplainedHand {
  SuggestedHand suggested;
  HandTrial trial;
};

/// Facts for the explanation that are not in the scene.
struct ExplainFacts {
  std::size_t answer_bytes = 0;                           ///< of the datagram that answers a motion in contact
  std::optional<Calibration> calibration = std::nullopt;  ///< none: costs are predictions only
  RingingDevice device{};                                 ///< for the margins of stability
  std::optional<ExplainedHand> hand = std::nullopt;       ///< none: no line about a hand
};

/// Lists what is simulated and what is not, as text of several lines: for each object and field its effects, the inputs
/// they need, cost, memory and stability; for the scene the total against a tick of 1 ms.
std::string explain(const scene::Scene& scene, const ExplainFacts& facts = {});

/// Objects, fields and dynamic models in one line: "ball (sphere): surface stiffness_N_per_m 10000, damping_N_s_per_m
/// 0".
std::string summary(const scene::Scene& scene);

}  // namespace forcebound::server
