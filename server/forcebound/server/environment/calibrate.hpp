#pragma once

#include <memory>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// Measured time for one motion, over many batches of motions.
struct MeasuredCost {
  double median_ns = 0;
  double p99_ns = 0;
  /// A part was quarantined during the measurement, because its force was not finite: the figures lack it.
  bool left_out = false;
};

/// The measured cost of a scene and of its parts.
struct Calibration {
  std::vector<MeasuredCost> parts{};  ///< each alone: the steps of the plan, then the dynamic models
  MeasuredCost motion{};              ///< a motion in an empty scene; included in each of the others
  MeasuredCost whole{};               ///< the whole scene
};

/// Measures the scene's computing time on this machine: a device of three axes (less if the scene has less) strokes
/// each object and dynamic model in turn, in and out of its surface. Each motion is answered with local models too, as
/// to a client that renders locally; so is what is predicted. Takes some tens of milliseconds an object, less than a
/// second where one is slow.
Calibration calibrate(const std::shared_ptr<const scene::Scene>& scene, const time::Clock& clock);

/// Measures the median time for one motion of such strokes, of batches with a force.
/// @param clock must outlive the result; called on any thread that compiles scenes
scene::MeasureCost measured_by(const time::Clock& clock);

}  // namespace forcebound::server
