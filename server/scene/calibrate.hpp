#pragma once

#include <memory>
#include <vector>

#include "forcebound/server/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// How long something took, over many batches of motions, for one motion.
struct MeasuredCost {
  double median_ns = 0;
  double p99_ns = 0;
};

struct Calibration {
  std::vector<MeasuredCost> steps{};  ///< of the plan, each alone
  MeasuredCost whole{};               ///< all of the scene
};

/// Measures what the scene takes on this machine now: a device of three axes (less if the scene has less) strokes each
/// object in turn, in and out of its surface. Takes some tens of milliseconds an object.
Calibration calibrate(const std::shared_ptr<const Scene>& scene, const time::Clock& clock);

}  // namespace forcebound::server
