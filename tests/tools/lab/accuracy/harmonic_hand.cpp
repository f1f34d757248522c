#include "tests/tools/lab/accuracy/harmonic_hand.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "forcebound/device/simulated/smooth_step.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {
namespace {

constexpr double kApproach_s = 0.5;

class HarmonicHand final : public device::Operator {
 public:
  HarmonicHand(const HarmonicMotion& motion, int degrees_of_freedom)
      : motion_(motion), degrees_of_freedom_(degrees_of_freedom) {}

  [[nodiscard]] std::string_view name() const noexcept override { return slides() ? "slide" : "press"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return kFollowingHand; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return degrees_of_freedom_; }

  [[nodiscard]] Target target(double time_s) const noexcept override {
    const device::SmoothStep approach = device::smooth_step(time_s / kApproach_s);
    const device::SmoothStep begin = device::smooth_step(time_s / kApproach_s - 1);
    const double turn_rad_per_s = 2 * std::numbers::pi * motion_.frequency_Hz;
    const double angle = turn_rad_per_s * kApproach_s * begin.integral;
    const double turning = turn_rad_per_s * begin.value;
    const double lift_m = motion_.clearance_m + motion_.depth_m;
    Target target{control::Vector::Zero(degrees_of_freedom_), control::Vector::Zero(degrees_of_freedom_)};
    auto position = target.position.head<3>();
    auto velocity = target.velocity.head<3>();
    position = motion_.on_surface_m;
    if (slides()) {
      position += 0.5 * motion_.length_m * std::sin(angle) * along();
      velocity = 0.5 * motion_.length_m * std::cos(angle) * turning * along();
      position += (motion_.clearance_m - lift_m * approach.value) * motion_.out;
      velocity -= lift_m / kApproach_s * approach.slope * motion_.out;
    } else {
      position += (motion_.clearance_m - 0.5 * lift_m * (1 - std::cos(angle))) * motion_.out;
      velocity = -0.5 * lift_m * std::sin(angle) * turning * motion_.out;
    }
    return target;
  }

  [[nodiscard]] std::string description() const override {
    using text::to_text;
    return std::string(name()) + ":frequency_Hz=" + to_text(motion_.frequency_Hz) +
           ",depth_m=" + to_text(motion_.depth_m) + ",clearance_m=" + to_text(motion_.clearance_m) +
           (slides() ? ",length_m=" + to_text(motion_.length_m) : "") + ",mass_kg=" + to_text(kFollowingHand.mass_kg) +
           ",stiffness_N_per_m=" + to_text(kFollowingHand.stiffness_N_per_m) +
           ",damping_N_s_per_m=" + to_text(kFollowingHand.damping_N_s_per_m);
  }

 private:
  [[nodiscard]] bool slides() const noexcept { return motion_.kind == HarmonicMotion::Kind::slide; }

  /// x on a surface across z, y across x, z across y.
  [[nodiscard]] Eigen::Vector3d along() const noexcept {
    return Eigen::Vector3d(motion_.out.z(), motion_.out.x(), motion_.out.y()).cwiseAbs();
  }

  HarmonicMotion motion_;
  int degrees_of_freedom_;
};

}  // namespace

std::unique_ptr<const device::Operator> make_harmonic_hand(const HarmonicMotion& motion, int degrees_of_freedom) {
  if (degrees_of_freedom < 3) {
    throw std::invalid_argument("press and slide need a device of 3 degrees of freedom, got " +
                                std::to_string(degrees_of_freedom));
  }
  return std::make_unique<HarmonicHand>(motion, degrees_of_freedom);
}

}  // namespace forcebound::lab
