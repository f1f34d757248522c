#pragma once

#include <map>
#include <string>

#include "forcebound/control/law_description.hpp"

namespace forcebound::python {

/// @param memory "capped" or "full"; @throws std::invalid_argument for another
[[nodiscard]] control::LawOptions law_options(const std::string& memory,
                                              const std::map<std::string, double>& parameters);

}  // namespace forcebound::python
