#include "forcebound/driver/driver_facts.hpp"

#include <cmath>
#include <stdexcept>
#include <string_view>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/damping.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::driver {
namespace {

using control::Matrix;
using control::Vector;

constexpr double kPeriodLeast_s = 1e-4;
constexpr double kPeriodMost_s = 0.1;
// Ten ticks: a device slower than that is not for 1 kHz.
constexpr double kDelayMost_s = 0.01;

class Checks {
 public:
  explicit Checks(std::string driver) : driver_(std::move(driver)) {}

  [[noreturn]] void refuse(std::string_view what, std::string_view accepted, double got) const {
    throw std::runtime_error(
        control::joined("driver '", driver_, "': its device's ", what, " must be ", accepted, ", got ", got));
  }

  double number(std::string_view what, double value, double least, double most) const {
    if (value >= least && value <= most) return value;
    refuse(what, control::joined("from ", least, " to ", most), value);
  }

  /// `dof` numbers >= 0.
  Vector bounds(std::string_view what, const double* values, int dof) const {
    for (int i = 0; i < dof; ++i) {
      if (!(values[i] >= 0) || !std::isfinite(values[i])) refuse(what, "finite and >= 0", values[i]);
    }
    return Eigen::Map<const Eigen::VectorXd>(values, dof);
  }

 private:
  std::string driver_;
};

}  // namespace

control::DeviceFacts facts_of(const forcebound_facts& told, const std::string& driver) {
  const Checks checks(driver);
  const int dof = told.degrees_of_freedom;
  if (dof < 1 || dof > FORCEBOUND_AXES_MAX) checks.refuse("degrees_of_freedom", "from 1 to 6", dof);
  control::DeviceFacts facts;
  const std::string_view name(told.name, ::strnlen(told.name, sizeof told.name));
  facts.name = text::printable(name.empty() ? std::string_view(driver) : name);
  facts.cartesian = told.in_joints == 0;
  facts.period_s = checks.number("period_s", told.period_s, kPeriodLeast_s, kPeriodMost_s);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  facts.damping = Eigen::Map<const RowMajor>(told.damping, dof, dof);
  try {
    (void)control::Damping::from_matrix(facts.damping);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error("driver '" + driver + "': its device's damping: " + error.what());
  }
  facts.friction = checks.bounds("friction", told.friction, dof);
  facts.encoder_step = checks.bounds("encoder_step", told.encoder_step, dof);
  facts.actuator_step = checks.bounds("actuator_step", told.actuator_step, dof);
  const Vector speed_max = checks.bounds("speed_max", told.speed_max, dof);
  if ((speed_max.array() > 0).all()) facts.speed_max = speed_max;
  facts.force_N_max = told.force_N_max;
  if (!(facts.force_N_max > 0) || !std::isfinite(facts.force_N_max)) {
    checks.refuse("force_N_max", "finite and > 0", told.force_N_max);
  }
  facts.releases = told.hold_s_max != 0;
  if (facts.releases) {
    facts.hold_s_max = checks.number("hold_s_max", told.hold_s_max, facts.period_s, 1);
    facts.release_share = checks.number("release_share", told.release_share, 0, 1);
    facts.release_s = checks.number("release_s", told.release_s, 0, 1 - facts.hold_s_max);
  }
  // At most so long: it may be none.
  facts.latency_s = checks.number("latency_s", told.latency_s, 0, kDelayMost_s);
  facts.uncertainty.latency_s = {-facts.latency_s, 0};
  const double stamp_s = checks.number("stamp_s_most", told.stamp_s_most, 0, kDelayMost_s);
  facts.uncertainty.stamp_s = {-stamp_s, stamp_s};
  return facts;
}

device::Safety safety_of(const forcebound_facts& told, const control::DeviceFacts& facts, const std::string& driver) {
  device::Safety safety = device::Safety::of_a_person(facts);
  if (!(told.force_N_continuous >= 0) || !std::isfinite(told.force_N_continuous)) {
    Checks(driver).refuse("force_N_continuous", "finite and >= 0", told.force_N_continuous);
  }
  if (told.force_N_continuous > 0) safety.rms_force_N_max = told.force_N_continuous;
  return safety;
}

}  // namespace forcebound::driver
