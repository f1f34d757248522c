#pragma once

#include <string>

#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {

/// The results of a study as the [accuracy] table of a scene file. Settings that failed are left out; no level's error
/// is given as smaller than the reference's uncertainty.
/// @throws std::runtime_error if fewer than two settings worked, or if the key is not of a scene
std::string levels_text(const StudyResult& result);

}  // namespace forcebound::lab
