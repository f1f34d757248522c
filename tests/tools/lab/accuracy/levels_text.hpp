#pragma once

#include <string>

#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {

/// What a study found, as the [accuracy] table of a scene file. Settings that failed are no levels; no
/// level's error is given as smaller than the reference's uncertainty.
/// @throws std::runtime_error if fewer than two settings worked, or the key is none of a scene
std::string levels_text(const StudyResult& result);

}  // namespace forcebound::lab
