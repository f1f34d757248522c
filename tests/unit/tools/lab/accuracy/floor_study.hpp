#pragma once

#include <string>

#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {

/// A clock on which every step takes as long: 50 us.
class EvenClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time::Nanoseconds{50000 * ++looks_}; }

 private:
  mutable std::int64_t looks_ = 0;
};

/// A floor at z = 0 of 100 N/m, with nothing to sweep yet.
inline Study floor_study(double round_trip_s) {
  return {.scene_text =
              "[scene]\nname = 'floor'\ndescription = ''\ndegrees_of_freedom = 3\n"
              "[[object]]\nname = 'floor'\nshape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }\n"
              "effects = ['surface']\nsurface = { stiffness_N_per_m = 100 }\n",
          .scene_file = "floor.toml",
          .sweep = {},
          .round_trips_s = {round_trip_s},
          .session = {.law = "none"},
          .duration_s = 1.5};
}

}  // namespace forcebound::lab
