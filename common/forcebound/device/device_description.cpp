#include "forcebound/device/device_description.hpp"

#include "forcebound/control/classic_text.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::device {
namespace {

// Only the diagonal, if the matrix is diagonal.
std::string written(const Matrix& matrix) {
  control::ClassicText text;
  const Eigen::IOFormat one_line(6, Eigen::DontAlignCols, " ", "; ", "", "", "[", "]");
  if (matrix.isDiagonal(0)) {
    text << Vector(matrix.diagonal()).transpose().format(one_line);
  } else {
    text << matrix.format(one_line);
  }
  return text.str();
}

/// "; may be off: ..." by all that is not known exactly; empty if all is.
std::string uncertainty_text(const control::Uncertainty& uncertainty) {
  control::ClassicText out;
  const auto bracket = [&](const char* what, const control::Bracket& b) {
    if (b != control::Bracket{}) out << ", " << what << " " << b.least << " to " << b.most << " s later";
  };
  const auto share = [&](const char* what, double value) {
    if (value > 0) out << ", " << what << " " << 100 * value << " %";
  };
  bracket("readings", uncertainty.stamp_s);
  bracket("forces", uncertainty.latency_s);
  bracket("all forces alike", uncertainty.latency_offset_s);
  bracket("release", uncertainty.hold_s);
  share("clock", uncertainty.clock_share);
  share("damping", uncertainty.damping_share);
  share("friction", uncertainty.friction_share);
  if (uncertainty.torque_gain_share != control::Bracket{}) {
    out << ", motors' gain " << 100 * uncertainty.torque_gain_share.least << " to "
        << 100 * uncertainty.torque_gain_share.most << " %"
        << (uncertainty.losses_with_gain ? " and losses alike" : "");
  }
  share("torque ripple", uncertainty.torque_ripple_share);
  if (uncertainty.encoder_steps > 0) out << ", encoder " << uncertainty.encoder_steps << " steps beyond rounding";
  if (uncertainty.actuator_lag_s > 0) out << ", actuator lag " << uncertainty.actuator_lag_s << " s";
  return out.str().empty() ? "" : "; may be off: " + out.str().substr(2);
}

/// "torque <= 0.2 N m, " of a device that shows one; empty of any other.
std::string torque_text(const control::DeviceFacts& facts) {
  if (facts.rotations == 0) return {};
  control::ClassicText out;
  out << "torque <= " << facts.torque_N_m_max << " N m, ";
  return out.str();
}

/// The description around the inertia.
std::string described(const control::DeviceFacts& facts, const std::string& mechanism, const std::string& inertia) {
  const bool joints = !facts.cartesian;
  control::ClassicText out;
  out << facts.name << ": "
      << text::counted(static_cast<std::uint64_t>(facts.degrees_of_freedom()), "degree of freedom",
                       "degrees of freedom")
      << ", " << mechanism << ", " << inertia << "damping " << written(facts.damping)
      << (joints ? " N m s/rad" : " N s/m") << ", friction " << written(facts.friction) << (joints ? " N m" : " N")
      << ", encoder " << written(facts.encoder_step) << (joints ? " rad" : " m") << ", force <= " << facts.force_N_max
      << " N, " << torque_text(facts) << "hold " << facts.hold_s_max << " s";
  if (facts.release_share > 0 && facts.release_s > 0) {
    out << ", then " << facts.release_share << " of it for " << facts.release_s << " s";
  }
  out << ", latency " << facts.latency_s << " s" << uncertainty_text(facts.uncertainty);
  return out.str();
}

}  // namespace

std::string describe(const DeviceDescription& device) {
  const bool joints = !device.facts.cartesian;
  return described(device.facts, in_words(device.geometry),
                   (joints ? "inertia " : "mass ") + written(device.inertia) + (joints ? " kg m^2, " : " kg, "));
}

std::string describe(const control::DeviceFacts& facts) {
  return described(facts, facts.cartesian ? "Cartesian" : "in its joints", "");
}

std::string HapticDevice::facts_in_words() const { return describe(facts()); }

}  // namespace forcebound::device
