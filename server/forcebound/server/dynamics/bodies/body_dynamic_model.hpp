#pragma once

#include <string>
#include <vector>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/description.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

class BodyWorld;

/// Rigid bodies by MuJoCo, and probes among them.
///
/// A step is MuJoCo's, of fixed length; what time is left is kept for the next advance. At most 50 steps an advance,
/// the rest is counted as slipped. Real time but for what MuJoCo does with its own memory, of which it allocates none
/// after the start.
///
/// A coupling must be stable with the apparent mass that it meets as the bodies begin. Elsewhere it is not judged: a
/// probe of MJCF that meets a smaller mass when its joints have turned needs that much room below what is stable. What
/// MJCF is unstable by itself is found by trying: 500 steps with the devices held a millimetre aside.
class BodyDynamicModel final : public scene::DynamicModel {
 public:
  /// From a description: a device drags a ball.
  /// @throws BodiesError also for a coupling that would be unstable, and for bodies that begin within each other and
  /// would fly apart, with the numbers.
  BodyDynamicModel(BodiesDescription description, std::string name);

  /// From MJCF: devices drag the bodies called `probes`, at least one, one each, by their centres of mass.
  /// @param solver what is to be otherwise than the model says
  /// @throws BodiesError also for a coupling that would be unstable, with the numbers, and for what flies apart or
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
