#pragma once

#include <memory>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// How long something took, over many batches of motions, for one motion.
struct MeasuredCost {
  double median_ns = 0;
  double p99_ns = 0;
  /// A part was left out meanwhile, because its force was not finite: the figures are not those of the whole.
  bool left_out = false;
};

/// The measured cost of a scene and of its parts.
struct Calibration {
  std::vector<MeasuredCost> parts{};  ///< each alone: the steps of the plan, then the dynamic models
  MeasuredCost motion{};              ///< a motion in a scene without any, which each of the others includes
  MeasuredCost whole{};               ///< all of the scene
};

/// Measures what the scene takes on this machine now: a device of three axes (less if the scene has less) strokes each
/// object and dynamic model in turn, in and out of its surface. Takes some tens of milliseconds an object, less than a
/// second where one is slow.
Calibration calibrate(const std::shared_ptr<const scene::Scene>& scene, const time::Clock& clock);

/// The median of all of a scene on such strokes, while a force is felt.
/// @param clock must outlive it, and may be asked by any thread that compiles scenes
scene::MeasureCost measured_by(const time::Clock& clock);

}  // namespace forcebound::server
