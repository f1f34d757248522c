#pragma once

#include <string>

#include "forcebound/client/commands/identify/identification.hpp"
#include "forcebound/control/device_facts.hpp"

namespace forcebound::client::commands::identify {

/// The findings as a file of facts, which `facts=FILE` of a driver takes: each line with the measurement that it comes
/// from. What was refused is a comment with the reason; where a law cannot do without it, the file does not load.
/// @param declared the driver's own facts: largest force, period, and the uncertainties that no motion tells
[[nodiscard]] std::string facts_text(const Findings& findings, const control::DeviceFacts& declared, double confidence);

/// The same as a table for a person.
[[nodiscard]] std::string findings_text(const Findings& findings, const control::DeviceFacts& declared);

/// A row for each slide, the data of slides.gnuplot:
/// joint,direction,speed,force,bound_damping,bound_friction,unit_speed, unit_force.
[[nodiscard]] std::string slides_csv(const Findings& findings, bool cartesian);

}  // namespace forcebound::client::commands::identify
