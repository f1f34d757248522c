#pragma once

namespace forcebound::program {

/// How programs of a build with FORCEBOUND_ROBOT=OFF refuse what asks for a robot.
inline constexpr const char* kWithoutRobots =
    "this program was built without robots; -DFORCEBOUND_ROBOT=ON builds it with them";

}  // namespace forcebound::program
