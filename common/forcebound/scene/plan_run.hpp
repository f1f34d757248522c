#pragma once

#include <cstddef>

#include "forcebound/scene/plan.hpp"

namespace forcebound::scene {

/// The steps of a plan at one point of one client, whose states it changes.
///
/// Real time: noexcept, no allocation.
class PlanRun {
 public:
  /// @param states Plan::state_bytes of the point, aligned for a double; zeros at first. Both must outlive this.
  PlanRun(const Plan& plan, std::byte* states) noexcept : plan_(plan), states_(states) {}

  /// Of a field, nothing.
  [[nodiscard]] SurfacePoint find_surface(const PlanStep& step, const Point& position_m) const noexcept {
    if (step.shape == nullptr) return {};
    return step.shape->nearest(position_m, states_ + step.shape_state);
  }

  /// Adds the step's effects. @param probe its pressure is set
  void act(const PlanStep& step, Probe& probe, Reaction& reaction) const noexcept;

  /// Of a shape that the point has not met. @param free_m outside of everything solid
  void begin_outside(const PlanStep& step, const Point& free_m) const noexcept {
    step.shape->begin_outside(free_m, states_ + step.shape_state);
  }

  /// As if the point had never met the step.
  void forget(const PlanStep& step) const noexcept { forget(step.shape_state, step.end_state); }

 private:
  void run(std::uint32_t begin, std::uint32_t end, const Probe& probe, Reaction& reaction) const noexcept;
  void forget(std::uint32_t begin, std::uint32_t end) const noexcept;

  const Plan& plan_;
  std::byte* states_;
};

}  // namespace forcebound::scene
