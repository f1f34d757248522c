#pragma once

#include <string>

#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"

namespace forcebound::baselines {

/// A law that ships, by its name, at work on a device: control::ForceBounder with its law, and what a Motion needs
/// beside the readings. Of this Python's and C's are made.
///
/// On each tick: set what was measured in `motion`, then `tick` or `release`. A Cartesian device's joints are its
/// position, and nothing else is read of them; of any other device each tick sets joints and Jacobian.
///
/// Real time: what is noexcept allocates nothing, O(dof^3). Not thread-safe; owned by the tick.
class RunningLaw {
 public:
  /// @throws std::invalid_argument as LawRegistry::make and ForceBounder
  RunningLaw(control::DeviceFacts facts, const std::string& name, control::LawOptions options);
  RunningLaw(const RunningLaw&) = delete;
  RunningLaw& operator=(const RunningLaw&) = delete;

  /// Of the next tick; its vectors have the device's rows, and keep them.
  [[nodiscard]] control::Motion& motion() noexcept { return motion_; }

  /// Sets the times of the motion, but for the interval, to what the facts say.
  void time_by_facts() noexcept;

  /// The force for the device [N]. @param request_N of as many rows
  [[nodiscard]] control::Vector tick(const control::Vector& request_N) noexcept;

  /// A tick without an answer of the environment.
  [[nodiscard]] control::Vector release() noexcept;

  /// False before the first tick.
  [[nodiscard]] bool begun() const noexcept { return begun_; }

  [[nodiscard]] control::ForceBounder& bounder() noexcept { return bounder_; }
  [[nodiscard]] const control::ForceBounder& bounder() const noexcept { return bounder_; }
  [[nodiscard]] const control::DeviceFacts& facts() const noexcept { return facts_; }

  /// With every parameter of the law.
  [[nodiscard]] const control::LawOptions& options() const noexcept { return options_; }

 private:
  void begin_tick() noexcept;

  control::DeviceFacts facts_;
  control::LawOptions options_;
  control::ForceBounder bounder_;
  control::Damping damping_;
  control::Motion motion_{};
  bool begun_ = false;
};

}  // namespace forcebound::baselines
