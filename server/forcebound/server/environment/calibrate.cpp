#include "forcebound/server/environment/calibrate.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/time/percentile.hpp"

namespace forcebound::server {
namespace {

// A batch takes longer than the clock's resolution and than reading the clock.
constexpr int kMotionsPerBatch = 32;
constexpr int kBatches = 1000;
constexpr Nanoseconds kPeriod = std::chrono::milliseconds{1};

// Slow scenes need smaller and fewer batches.
constexpr Nanoseconds kBatchLong = std::chrono::milliseconds{1};
constexpr Nanoseconds kLong = std::chrono::milliseconds{300};
constexpr int kBatchesLeast = 40;

/// A tool touches with its points.
constexpr scene::Handle kUpright{.orientation = scene::Handle::Orientation{1, 0, 0, 0}};

/// A stroke about 2 mm to and fro on each axis, that is on both sides of a surface through its middle.
Vector on_stroke(const scene::Point& middle_m, int motion, Eigen::Index rows) {
  const double turn = 0.01 * motion;
  const scene::Point place =
      middle_m + 1e-3 * scene::Point(std::sin(turn), std::sin(0.77 * turn + 1), std::sin(1.31 * turn + 3));
  return place.head(rows);
}

/// Motions in one place after the other: a device does not leap between them.
class Measurement {
 public:
  Measurement(scene::SceneState state, Eigen::Index rows, const time::Clock& clock)
      : state_(std::move(state)), rows_(rows), clock_(clock) {}

  /// @param share of all batches and of all time
  void stroke(const scene::Point& middle_m, int share) {
    const Nanoseconds begin = clock_.now();
    int motion = 0;
    for (int batch = 0; batch * share < kBatches; ++batch) {
      if (batch >= kBatchesLeast && (clock_.now() - begin) * share > kLong) break;
      motion += run_batch(middle_m, motion);
    }
  }

  /// The median of those batches in which a force was felt all the time, if there were any.
  [[nodiscard]] double felt_median_ns() { return time::percentile_of(felt_ns_.empty() ? costs_ns_ : felt_ns_, 0.5); }

  [[nodiscard]] MeasuredCost result() {
    return {time::percentile_of(costs_ns_, 0.5), time::percentile_of(costs_ns_, 0.99), left_out_};
  }

 private:
  int run_batch(const scene::Point& middle_m, int first) {
    places_.clear();
    for (int i = 0; i < per_batch_; ++i) places_.push_back(on_stroke(middle_m, first + i, rows_));
    bool felt = true;
    const Nanoseconds begin = clock_.now();
    for (const Vector& place : places_) {
      device_time_ += kPeriod;
      const scene::Answer answer = state_.answer(place, device_time_, device_time_, true, kUpright);
      left_out_ = !state_.quarantined().empty() || left_out_;
      felt = felt && !answer.force.isZero(0);
    }
    const Nanoseconds taken = clock_.now() - begin;
    const auto motions = static_cast<int>(places_.size());
    costs_ns_.push_back(static_cast<double>(taken.count()) / motions);
    if (felt) felt_ns_.push_back(costs_ns_.back());
    if (taken > kBatchLong) per_batch_ = std::max(1, per_batch_ / 4);
    return motions;
  }

  scene::SceneState state_;
  Eigen::Index rows_;
  const time::Clock& clock_;
  int per_batch_ = kMotionsPerBatch;
  Nanoseconds device_time_{0};
  std::vector<Vector> places_;
  std::vector<double> costs_ns_;
  std::vector<double> felt_ns_;
  bool left_out_ = false;
};

Measurement measure(scene::SceneState state, const std::vector<scene::Point>& middles_m, Eigen::Index rows,
                    const time::Clock& clock) {
  Measurement measurement(std::move(state), rows, clock);
  for (const scene::Point& middle_m : middles_m) measurement.stroke(middle_m, static_cast<int>(middles_m.size()));
  return measurement;
}

Eigen::Index rows_of(const scene::Scene& scene) {
  const int wanted = scene.facts().degrees_of_freedom;
  return wanted == scene::kAnyDegreesOfFreedom ? 1 : wanted;
}

Measurement measure_whole(const std::shared_ptr<const scene::Scene>& scene, const time::Clock& clock) {
  std::vector<scene::Point> middles_m;
  for (std::size_t i = 0; i < scene->parts(); ++i) middles_m.push_back(scene->on_surface_m(i));
  if (middles_m.empty()) middles_m.emplace_back(scene::Point::Zero());
  const Eigen::Index rows = rows_of(*scene);
  return measure(scene::SceneState(scene, static_cast<std::uint32_t>(rows)), middles_m, rows, clock);
}

std::shared_ptr<const scene::Scene> empty_scene() {
  return parse_scene("scene = { name = 'empty', description = 'nothing', degrees_of_freedom = 'any' }\n", "empty");
}

}  // namespace

Calibration calibrate(const std::shared_ptr<const scene::Scene>& scene, const time::Clock& clock) {
  const Eigen::Index rows = rows_of(*scene);
  const auto dof = static_cast<std::uint32_t>(rows);
  Calibration calibration;
  for (std::size_t i = 0; i < scene->parts(); ++i) {
    scene::SceneState part = scene::SceneState::of_part(scene, dof, i);
    calibration.parts.push_back(measure(std::move(part), {scene->on_surface_m(i)}, rows, clock).result());
  }
  calibration.motion = measure_whole(empty_scene(), clock).result();
  calibration.whole = measure_whole(scene, clock).result();
  return calibration;
}

scene::MeasureCost measured_by(const time::Clock& clock) {
  return [&clock](const std::shared_ptr<const scene::Scene>& scene) {
    return 1e-9 * measure_whole(scene, clock).felt_median_ns();
  };
}

}  // namespace forcebound::server
