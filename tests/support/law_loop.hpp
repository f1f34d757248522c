#pragma once

#include <string_view>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/support/ideal_device.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::test {

struct LawLoopSetting {
  double period_s = kPeriod_s;
  double force_N_max = kInfinity;
  double actuator_step_N = 0;
  control::LawParameters parameters{};
};

/// A law on a Cartesian device; the test gives motion and request.
class LawLoop {
 public:
  LawLoop(std::string_view law, const control::Matrix& damping, const LawLoopSetting& setting = {})
      : interval_s_(setting.period_s),
        damping_(control::Damping::from_matrix(damping)),
        unit_(control::Matrix::Identity(damping.rows(), damping.rows())),
        bounder_(make_bounder(law, damping, setting)) {}

  control::Vector tick(const control::Vector& position, const control::Vector& request_N) noexcept {
    control::Motion motion;
    motion.interval_s = interval_s_;
    motion.position = motion.joint = position;
    motion.jacobian = unit_;
    motion.damping = &damping_;
    return bounder_.tick(motion, request_N);
  }

  /// One degree of freedom.
  double tick(double position_m, double request_N) noexcept {
    return tick(control::Vector::Constant(1, position_m), control::Vector::Constant(1, request_N))[0];
  }

  /// The measured time between readings, from the coming tick on.
  void set_interval(double interval_s) noexcept { interval_s_ = interval_s; }

  /// From the coming tick on.
  void set_damping(const control::Matrix& damping) { damping_ = control::Damping::from_matrix(damping); }

  /// The position at which the environment is asked next, if the device is at `position`.
  [[nodiscard]] control::Vector proxy_position(const control::Vector& position) const noexcept {
    return bounder_.law().proxy_position(position);
  }

  [[nodiscard]] double energy_J() const noexcept { return bounder_.law().energy_J(); }
  [[nodiscard]] double xi() const noexcept { return bounder_.law().xi(); }
  [[nodiscard]] const control::ForceBounder::Counts& counts() const noexcept { return bounder_.counts(); }

 private:
  static control::ForceBounder make_bounder(std::string_view law, const control::Matrix& damping,
                                            const LawLoopSetting& setting) {
    control::DeviceFacts facts = ideal_device(damping);
    facts.period_s = setting.period_s;
    facts.actuator_step = control::Vector::Constant(damping.rows(), setting.actuator_step_N);
    facts.force_N_max = setting.force_N_max;
    return {facts, baselines::shipped_laws().make(law, facts, {.parameters = setting.parameters})};
  }

  double interval_s_;
  control::Damping damping_;
  control::Matrix unit_;
  control::ForceBounder bounder_;
};

/// A law on one axis of the paper's device.
inline LawLoop one_axis(std::string_view law, const control::LawParameters& parameters = {}) {
  return LawLoop(law, control::Matrix::Constant(1, 1, kDamping_N_s_per_m), {.parameters = parameters});
}

inline control::Vector to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

inline control::Matrix to_matrix(const std::vector<std::vector<double>>& rows) {
  control::Matrix result(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(rows.at(0).size()));
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    result.row(i) = to_vector(rows[static_cast<std::size_t>(i)]).transpose();
  }
  return result;
}

}  // namespace forcebound::test
