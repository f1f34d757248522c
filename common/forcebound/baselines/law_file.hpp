#pragma once

#include <string>
#include <string_view>

#include "forcebound/control/law_registry.hpp"

namespace forcebound::baselines {

/// The parameters of one law from the text of a TOML file that has a table for each law:
///
///     [vc]
///     coupling_N_per_m = 40000
///
/// Parameters that are left out, or laws without a table, keep their standard values. The tables of the other laws are
/// checked as well, so that one file can serve them all.
///
/// @param place the file's name, for errors.
/// @throws std::runtime_error `PLACE:LINE: law 'vc': coupling_N_per_m must be ..., got ...`; unknown laws and
/// parameters are errors.
[[nodiscard]] control::LawParameters parse_law_parameters(std::string_view toml_text, const std::string& place,
                                                          std::string_view law, const control::LawRegistry& laws);

/// The same from a file.
/// @throws std::runtime_error as parse_law_parameters, or if there is no such file.
[[nodiscard]] control::LawParameters load_law_parameters(const std::string& file, std::string_view law,
                                                         const control::LawRegistry& laws);

/// "coupling_N_per_m 40000, tool_mass_kg 0.03", as text.
[[nodiscard]] std::string describe(const control::LawParameters& parameters);

}  // namespace forcebound::baselines
