#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

#include "forcebound/record/tick_record.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::lab {

/// What one run showed, from the first contact on.
struct RenderingFigures {
  /// RMS of (force applied - force of the true scene at the device's true place), over that of the latter: E_dev. What
  /// moves in the true scene is moved by this run's device, at once and on each tick.
  double error = 0;
  /// Displayed: least squares of the force out of the surface over the true depth. Not a number where there is none.
  double stiffness_N_per_m = 0;
  double true_share = 0;       ///< least squares of the force applied over the true force: their dot over its square
  double change_N_per_ms = 0;  ///< of the force applied, from one tick to the next: the largest
  double felt_tick = 0;        ///< on which a force was applied first; infinite: never
  double minimum_J = 0;        ///< of P
  double at_client = 0;        ///< share of the ticks since the first contact that were rendered there
  double ready_s = 0;          ///< from the start to the first tick rendered there; infinite: never
  double scene_bytes = 0;      ///< of the scene, as it came
  double start_B_per_s = 0;    ///< payloads sent, both ways, in the first second
  double steady_B_per_s = 0;   ///< the same at the end of the run
  double motions_per_s = 0;    ///< sent
};

/// Displayed stiffness over that without a network. Where nothing is touched below a surface, as where a body is
/// dragged through free space: the share of the true force that is applied, over that without a network.
[[nodiscard]] double displayed_over(const RenderingFigures& run, const RenderingFigures& without_network);

/// Compares what was applied with what the true scene says at the device's true place.
class TrueForceMeter final : public record::TickSink {
 public:
  /// @param from_s after the first tick; what is before is passed over
  TrueForceMeter(const std::shared_ptr<const scene::Scene>& scene, std::uint32_t degrees_of_freedom, double from_s = 0)
      : truth_(scene, degrees_of_freedom), from_s_(from_s) {}

  void on_tick(const record::TickRecord& tick) noexcept override;

  /// Of the ticks alone; what was sent is not known here.
  [[nodiscard]] RenderingFigures figures() const;

  std::function<control::Vector()> place_of;  ///< on the tick, of the device [m]

 private:
  scene::SceneState truth_;
  double from_s_;
  std::optional<time::Nanoseconds> first_;
  double felt_tick_ = std::numeric_limits<double>::infinity();
  double ready_s_ = std::numeric_limits<double>::infinity();
  bool touched_ = false;
  control::Vector last_applied_{};
  double change_N_per_ms_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint64_t at_client_ = 0;
  double error_ = 0;
  double along_ = 0;
  double reference_ = 0;
  double force_by_depth_ = 0;
  double depth_squared_ = 0;
};

}  // namespace forcebound::lab
