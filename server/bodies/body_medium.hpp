#pragma once

#include <string>
#include <vector>

#include "forcebound/server/bodies/description.hpp"
#include "forcebound/server/bodies/mujoco.hpp"
#include "forcebound/server/effects/medium.hpp"

namespace forcebound::server {

/// How a probe is tied to its device: a virtual coupling (Colgate, Stanley, Brown 1995), integrated in steps of h
/// together with the bodies,
///
///     f = K (x_d - x_p) + B (v_d - v_p)   on the probe of mass m,    -f on the device
///
/// x_d comes straight to the device's newest position with its velocity v_d, over the time between two. The damper is
/// explicit in time, so the coupling by itself is stable only while both
///
///     h^2 K/m + 2 h B/m < 4,     h B/m < 2
struct Coupling {
  double stiffness_N_per_m = 600;
  double damping_N_s_per_m = 4;

  /// The larger of h^2 K/m + 2 h B/m over 4 and h B/m over 2: below 1 is stable.
  [[nodiscard]] double load(double mass_kg, double step_s) const noexcept;
};

/// Rigid bodies by MuJoCo, and probes among them.
///
/// A step is MuJoCo's, of fixed length; what time is left is kept for the next advance. At most 50 steps an advance,
/// the rest is counted as slipped. Real time but for what MuJoCo does with its own memory, of which it allocates none
/// after the start.
class BodyMedium final : public Medium {
 public:
  /// From a description.
  /// @throws BodiesError also for a coupling that would be unstable, and for bodies that begin within each other and
  /// would fly apart, with the numbers.
  BodyMedium(BodiesDescription description, std::string name);

  /// From MJCF: devices drag the bodies called `probes`, one each.
  /// @throws BodiesError
  BodyMedium(ModelPointer model, const std::vector<std::string>& probes, const Coupling& coupling, std::string name);

  [[nodiscard]] std::unique_ptr<MediumState> make_state(int seats) const override;
  [[nodiscard]] MediumFacts facts() const override;

 private:
  void check_coupling(double mass_kg) const;
  void check_overlap() const;
  [[nodiscard]] ModelPointer copy_of_model() const;

  BodiesDescription description_;  ///< no bodies: there is an MJCF model
  std::string name_;
  Coupling coupling_;
  ModelPointer model_;
  std::vector<int> probe_bodies_{};  ///< in the MJCF model
};

}  // namespace forcebound::server
