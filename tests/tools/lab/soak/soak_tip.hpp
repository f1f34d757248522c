#pragma once

#include <cstdint>

namespace forcebound::lab {

/// What is in the hand.
enum class SoakTip : std::uint8_t {
  point,
  tool,  ///< that has a shape, in a shipped scene, on a device of six axes; environments turn it, too
};

}  // namespace forcebound::lab
