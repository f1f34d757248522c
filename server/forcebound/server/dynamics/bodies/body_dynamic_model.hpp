#pragma once

#include <string>
#include <vector>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/description.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

class BodyWorld;

/// Rigid bodies by MuJoCo, with probes among them.
///
/// MuJoCo steps with fixed length; the remaining time is kept for the next advance. At most 50 steps an advance; the
/// rest is counted as slipped. Real time, except for MuJoCo's own use of its memory, of which it allocates none after
/// the start.
///
/// A coupling must be stable with the apparent mass that it has in the bodies' initial positions. Other positions are
/// not checked: a probe of MJCF whose apparent mass falls when its joints turn needs that much margin. MJCF that is
/// unstable by itself is found by a trial: 500 steps with the devices held a millimetre aside.
class BodyDynamicModel final : public scene::DynamicModel {
 public:
  /// From a description: a device drags a ball.
  /// @throws BodiesError also for an unstable coupling and for bodies that overlap at the start, which would fly apart,
  /// with the numbers.
  BodyDynamicModel(BodiesDescription description, std::string name);

  /// From MJCF: devices drag the bodies called `probes`, at least one, one each, by their centres of mass.
  /// @param solver overrides of the model's own settings
  /// @throws BodiesError also for an unstable coupling, with the numbers, and for a model that diverges or
  /// stops MuJoCo within those 500 steps.
  BodyDynamicModel(ModelPointer model, const std::vector<std::string>& probes, const Coupling& coupling,
                   std::string name, const SolverOptions& solver = {});

  [[nodiscard]] std::unique_ptr<scene::DynamicModelState> make_state(int seats) const override;
  [[nodiscard]] scene::DynamicModelFacts facts() const override;

 private:
  void check_overlap(const mjData_& data, int ball) const;
  void check_coupling() const;
  void check_motion() const;
  [[nodiscard]] std::unique_ptr<BodyWorld> make_world() const;
  [[nodiscard]] double share_of_stable() const noexcept;

  BodiesDescription description_;  ///< no bodies: there is an MJCF model
  std::string name_;
  Coupling coupling_;
  ModelPointer model_;
  std::vector<int> dragged_{};  ///< in the MJCF model; empty: balls
  double apparent_mass_kg_ = 0;
  scene::Point on_surface_m_ = scene::Point::Zero();
};

}  // namespace forcebound::server
