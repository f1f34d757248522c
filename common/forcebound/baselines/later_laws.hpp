#pragma once

#include "forcebound/control/law_description.hpp"

/// Approaches that came after the paper [Kim 2015], for the same comparison as those of `baselines.hpp`.
namespace forcebound::baselines {

/// `iss`: the loop of device and environment is input-to-state stable, which asks for less than passivity.
[[nodiscard]] control::LawDescription input_to_state_stability();

/// `tdpa-er`: time-domain passivity that sends back energy which the other end does not use, without drift.
[[nodiscard]] control::LawDescription energy_reflection();

/// `tdpa-priority`: time-domain passivity that dissipates in one direction first, and the rest across it.
[[nodiscard]] control::LawDescription prioritised_dissipation();

}  // namespace forcebound::baselines
