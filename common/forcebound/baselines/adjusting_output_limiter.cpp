#include <algorithm>
#include <memory>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/ledger.hpp"

namespace forcebound::baselines {
namespace {

/// @throws std::invalid_argument unless degrees of freedom are 1 to 6 and period [s] > 0.
std::vector<control::Ledger> make_axes(int degrees_of_freedom, double period_s) {
  (void)control::HeldForce(degrees_of_freedom, period_s);
  return {static_cast<std::size_t>(degrees_of_freedom), control::Ledger(1, period_s)};
}

/// The adjusting output limiter: each axis spends only the energy credited to that axis.
///
/// Vectors have `dof` rows in the device frame: position [m], force on the device [N]; B_i = b_i/T.
///
///     E_i,n = E_i,n-1 + B_i d_i^2 - f_i,n-1 d_i        E_i,0 = 0
///     |f_i| <= 2 sqrt(B_i max(E_i, 0))                 [Lee & Lee 2009, for one degree of freedom]
///
/// Published for one degree of freedom, where it equals LessConservativeLaw. In several, the axes are independent, so a
/// force changes its direction when one of its axes is short of energy. What an axis may credit where the damping
/// couples the axes is ours: `diagonal_below(b)`, so that together they credit no more than the device dissipates.
///
/// Passive where readings are exact, ticks punctual and forces immediate.
/// Real time: noexcept, no allocation; O(dof), and O(dof^3) where the damping couples axes.
class AdjustingOutputLimiter final : public control::PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 6 and period [s] > 0.
  AdjustingOutputLimiter(int degrees_of_freedom, double period_s) : axes_(make_axes(degrees_of_freedom, period_s)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "aol"; }

  void credit(const control::Motion& motion) noexcept override {
    const Vector damping = control::diagonal_below(motion.damping->matrix());
    control::Motion along;
    along.interval_s = motion.interval_s;
    along.held_s = motion.held_s;
    for (Eigen::Index i = 0; i < damping.rows(); ++i) {
      const control::Damping own = control::Damping::of_axis(damping[i]);
      along.damping = &own;
      along.position = motion.position.segment(i, 1);
      axis(i).credit(along);
    }
  }

  void lose(const control::Motion& motion) noexcept override {
    for (control::Ledger& axis : axes_) axis.lose(motion.interval_s);
  }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    Vector force = request_N;
    for (Eigen::Index i = 0; i < force.rows(); ++i) {
      force.segment(i, 1) = axis(i).held().bounded(request_N.segment(i, 1), axis(i).energy_J());
    }
    return force;
  }

  [[nodiscard]] bool allows(const Vector& force_N, double /*latency_s*/) const noexcept override {
    for (Eigen::Index i = 0; i < force_N.rows(); ++i) {
      if (!axis(i).held().affords(force_N.segment(i, 1), axis(i).energy_J())) return false;
    }
    return true;
  }

  void commit(const Vector& force_N) noexcept override {
    for (Eigen::Index i = 0; i < force_N.rows(); ++i) axis(i).hold(force_N.segment(i, 1));
  }

  /// The sum of E_i [J]; each axis spends only its own.
  [[nodiscard]] double energy_J() const noexcept override {
    control::EnergySum sum;
    for (const control::Ledger& axis : axes_) sum.add(axis.energy_J());
    return sum.value_J();
  }

 private:
  [[nodiscard]] control::Ledger& axis(Eigen::Index i) noexcept { return axes_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const control::Ledger& axis(Eigen::Index i) const noexcept {
    return axes_[static_cast<std::size_t>(i)];
  }

  std::vector<control::Ledger> axes_;
};

}  // namespace

control::LawDescription adjusting_output_limiter() {
  return {
      .name = "aol",
      .summary = "adjusting output limiter: each axis spends only its own energy, so a force may change its direction",
      .reference = "Lee & Lee 2009, for one degree of freedom",
      .claim = control::LawClaim::passive_if_ideal,
      .make = [](const control::DeviceFacts& facts, const control::LawOptions& /*options*/) {
        return std::make_unique<AdjustingOutputLimiter>(facts.degrees_of_freedom(), facts.period_s);
      }};
}

}  // namespace forcebound::baselines
