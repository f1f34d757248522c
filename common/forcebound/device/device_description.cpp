#include "forcebound/device/device_description.hpp"

#include <sstream>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::device {
namespace {

// Only the diagonal, if the matrix is diagonal.
std::string written(const Matrix& matrix) {
  std::ostringstream text;
  const Eigen::IOFormat one_line(6, Eigen::DontAlignCols, " ", "; ", "", "", "[", "]");
  if (matrix.isDiagonal(0)) {
    text << Vector(matrix.diagonal()).transpose().format(one_line);
  } else {
    text << matrix.format(one_line);
  }
  return text.str();
}

/// The description around the inertia.
std::string described(const control::DeviceFacts& facts, const std::string& inertia) {
  const bool arm = !facts.cartesian;
  std::ostringstream out;
  out << facts.name << ": "
      << text::counted(static_cast<std::uint64_t>(facts.degrees_of_freedom()), "degree of freedom",
                       "degrees of freedom")
      << ", " << (arm ? "serial arm, " : "Cartesian, ") << inertia << "damping " << written(facts.damping)
      << (arm ? " N m s/rad" : " N s/m") << ", friction " << written(facts.friction) << (arm ? " N m" : " N")
      << ", encoder " << written(facts.encoder_step) << (arm ? " rad" : " m") << ", force <= " << facts.force_N_max
      << " N, hold " << facts.hold_s_max << " s, latency " << facts.latency_s << " s";
  return out.str();
}

}  // namespace

std::string describe(const DeviceDescription& device) {
  const bool arm = device.arm.has_value();
  return described(device.facts,
                   (arm ? "inertia " : "mass ") + written(device.inertia) + (arm ? " kg m^2, " : " kg, "));
}

std::string describe(const control::DeviceFacts& facts) { return described(facts, ""); }

std::string HapticDevice::facts_in_words() const { return describe(facts()); }

}  // namespace forcebound::device
