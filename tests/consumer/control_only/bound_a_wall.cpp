// A first program with the package: a wall too stiff for the device, bounded by the law.
#include <forcebound/control/force_bounder.hpp>
#include <forcebound/control/law_registry.hpp>

#include <algorithm>
#include <cstdio>

namespace control = forcebound::control;

int main() {
  control::DeviceFacts facts;
  facts.name = "a device of one axis";
  facts.damping = control::Matrix::Constant(1, 1, 30.0);  // N s/m
  facts.friction = control::Vector::Zero(1);
  facts.encoder_step = control::Vector::Zero(1);
  facts.actuator_step = control::Vector::Zero(1);
  facts.force_N_max = 30.0;
  control::ForceBounder bounder(facts, control::force_bounding_laws().make("fba-more", facts));

  const auto damping = control::Damping::from_matrix(facts.damping);
  const double stiffness_N_per_m = 150e3;
  double stiffness_shown_max = 0;
  for (int n = 1; n <= 100; ++n) {
    const double position_m = 1e-6 * n;  // pressing on, 1 mm/s
    control::Motion motion;
    motion.interval_s = n == 1 ? 0.0 : facts.period_s;
    motion.position = motion.joint = control::Vector::Constant(1, position_m);
    motion.jacobian = control::Matrix::Identity(1, 1);
    motion.damping = &damping;
    const control::Vector force = bounder.tick(motion, control::Vector::Constant(1, -stiffness_N_per_m * position_m));
    stiffness_shown_max = std::max(stiffness_shown_max, -force(0) / position_m);
  }
  const double most = 2 * 30.0 / facts.period_s;  // [N/m] that a device of this damping can show passively
  std::printf("asked for %.0f N/m, showed up to %.0f of at most %.0f N/m\n", stiffness_N_per_m, stiffness_shown_max,
              most);
  return stiffness_shown_max > 0.5 * most && stiffness_shown_max <= most * (1 + 1e-9) ? 0 : 1;
}
