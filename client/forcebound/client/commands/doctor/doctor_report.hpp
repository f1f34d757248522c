#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/client/commands/doctor/doctor_verdict.hpp"
#include "forcebound/client/commands/doctor/findings.hpp"

namespace forcebound::client::commands {

/// For a terminal, in lines of at most text::kColumns columns.
[[nodiscard]] std::string doctor_text(const DoctorFindings& findings, const DoctorVerdict& verdict);

/// All of it, for a program. What is not known is null; without a limit, a limit is null.
[[nodiscard]] nlohmann::ordered_json doctor_json(const DoctorFindings& findings, const DoctorVerdict& verdict);

}  // namespace forcebound::client::commands
