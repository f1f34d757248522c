#pragma once

#include <string>

#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {

/// What a study found, as the [accuracy] table of a scene file. Settings that failed are no levels; nobody is more
/// exact than the reference is known to be.
/// @throws std::runtime_error if fewer than two settings worked, or the key is none of a scene
std::string levels_text(const StudyResult& result);

}  // namespace forcebound::lab
