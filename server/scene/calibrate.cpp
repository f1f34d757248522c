#include "forcebound/server/scene/calibrate.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/server/scene/scene_state.hpp"

namespace forcebound::server {
namespace {

// A clock's own cost and step must not show: a batch takes longer than both.
constexpr int kMotionsPerBatch = 32;
constexpr int kBatches = 1000;
constexpr Nanoseconds kPeriod = std::chrono::milliseconds{1};

/// A stroke about 2 mm to and fro on each axis, that is on both sides of a surface through its middle.
std::vector<Vector> stroke(const Point& middle_m, Eigen::Index rows) {
  std::vector<Vector> places;
  for (int motion = 0; motion < kMotionsPerBatch * kBatches; ++motion) {
    const double turn = 0.01 * motion;
    const Point place = middle_m + 1e-3 * Point(std::sin(turn), std::sin(0.77 * turn + 1), std::sin(1.31 * turn + 2));
    places.emplace_back(place.head(rows));
  }
  return places;
}

MeasuredCost measure(SceneState state, const std::vector<Point>& middles_m, Eigen::Index rows,
                     const time::Clock& clock) {
  std::vector<std::vector<Vector>> strokes;
  strokes.reserve(middles_m.size());
  for (const Point& middle_m : middles_m) strokes.push_back(stroke(middle_m, rows));
  std::vector<double> costs_ns;
  Nanoseconds device_time{0};
  bool left_out = false;
  for (std::size_t batch = 0; batch < kBatches; ++batch) {
    // One part after the other: a device does not leap between them.
    const Vector* place = &strokes[batch * strokes.size() / kBatches][batch * kMotionsPerBatch];
    const Nanoseconds begin = clock.now();
    for (int i = 0; i < kMotionsPerBatch; ++i) {
      device_time += kPeriod;
      left_out = !state.answer(*place++, device_time).quarantined.empty() || left_out;
    }
    costs_ns.push_back(static_cast<double>((clock.now() - begin).count()) / kMotionsPerBatch);
  }
  std::sort(costs_ns.begin(), costs_ns.end());
  return {costs_ns[kBatches / 2], costs_ns[kBatches * 99 / 100], left_out};
}

}  // namespace

Calibration calibrate(const std::shared_ptr<const Scene>& scene, const time::Clock& clock) {
  const int wanted = scene->facts().degrees_of_freedom;
  const Eigen::Index rows = wanted == kAnyDegreesOfFreedom ? 1 : wanted;
  const auto dof = static_cast<std::uint32_t>(rows);
  Calibration calibration;
  std::vector<Point> middles_m;
  for (std::size_t i = 0; i < scene->parts(); ++i) {
    const Point middle_m = scene->on_surface_m(i);
    middles_m.push_back(middle_m);
    calibration.parts.push_back(measure(SceneState::of_part(scene, dof, i), {middle_m}, rows, clock));
  }
  if (middles_m.empty()) middles_m.emplace_back(Point::Zero());
  calibration.whole = measure(SceneState(scene, dof), middles_m, rows, clock);
  return calibration;
}

}  // namespace forcebound::server
