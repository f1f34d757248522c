#include <algorithm>

#include "forcebound/server/follower/architecture.hpp"
#include "forcebound/server/follower/contact_estimator.hpp"

namespace forcebound::server {
namespace {

// A stiffness that is less sure is not told.
constexpr double kCertaintyLeast = 0.5;
// Below that height above the plane the tool is pressed with the force that the hand feels.
constexpr double kNear_m = 3e-3;
// The force loop on top of the torques asked for, which are right but for the robot's friction.
constexpr double kForceLoop_per_s = 5;
constexpr double kHeldBackMost_N = 15;
// How fast a plane that was found late comes to where it is.
constexpr double kEase_m_per_s = 0.01;

/// The robot tells not of forces but of what it feels: a plane, its stiffness and its friction, estimated as it works.
/// The device renders that at its own rate, without any delay [Hannaford 1989; Mitra and Niemeyer 2008].
///
///     f = K n max(0, n.(p - x_wanted))            K, p, n of ContactEstimator
///
/// Where the device is within the plane, the robot is asked to press as hard as the hand does, there where the surface
/// gives way to under that force. On the first touch the device is deeper than the plane by as much as the round trip
/// allowed: then the plane is told as lying so much deeper that its force is the one sensed, and comes to its own place
/// by 10 mm/s, or at once as far as the hand withdraws. So an unknown surface is felt late, and softly but for what the
/// hand moved on meanwhile: that step is the client's to bound (--force-slew).
class ModelMediated final : public Architecture {
 public:
  explicit ModelMediated(const ImpedanceSettings& impedance) noexcept : force_N_max_(impedance.force_N_max) {}

  [[nodiscard]] ToolTarget ask(const Sample& sample) noexcept override {
    const std::uint32_t before = reported_id();
    const Eigen::Vector3d sensed_N = sample.sensed.value_or(Vector6::Zero()).head<3>();
    const FeltSurface& felt = estimator_.update(sample.now, sample.tool.position, sample.velocity.head<3>(), sensed_N);
    if (!is_reported()) return sample.target;
    const double depth_m = (felt.place_m - sample.target.pose.position).dot(felt.normal);
    if (reported_id() != before && sample.sensed) {
      ease_m_ = std::max(0.0, depth_m - sensed_N.norm() / felt.stiffness_N_per_m);
    }
    ease_m_ = std::clamp(ease_m_ - kEase_m_per_s * sample.elapsed_s, 0.0, std::max(0.0, depth_m));
    ToolTarget asked = sample.target;
    if (depth_m > 0) {
      // Where a surface of that stiffness gives way to, under that force.
      asked.pose.position += ease_m_ * felt.normal;
      if ((sample.tool.position - felt.place_m).dot(felt.normal) < kNear_m) {
        asked.push_N = -held_N(pressed_N(depth_m - ease_m_), sample) * felt.normal;
      }
    }
    return asked;
  }

  void begin() noexcept override {
    ease_m_ = 0;
    held_back_N_ = 0;
  }

  [[nodiscard]] Reflection reflection() const noexcept override {
    Reflection told{.force_N_max = force_N_max_};
    if (!is_reported()) return told;
    const FeltSurface& felt = estimator_.surface();
    told.plane = ReflectedPlane{.id = felt.id,
                                .place_m = felt.place_m - ease_m_ * felt.normal,
                                .normal = felt.normal,
                                .stiffness_N_per_m = felt.stiffness_N_per_m,
                                .friction = felt.friction};
    return told;
  }

 private:
  [[nodiscard]] bool is_reported() const noexcept {
    const FeltSurface& felt = estimator_.surface();
    return felt.known && felt.certainty >= kCertaintyLeast;
  }
  [[nodiscard]] std::uint32_t reported_id() const noexcept { return is_reported() ? estimator_.surface().id : 0; }
  [[nodiscard]] double pressed_N(double depth_m) const noexcept {
    return std::clamp(estimator_.surface().stiffness_N_per_m * depth_m, 0.0, force_N_max_);
  }

  /// The force to ask for so that the sensor feels the one wanted: the robot's own friction holds some of it back.
  [[nodiscard]] double held_N(double wanted_N, const Sample& sample) noexcept {
    if (!sample.sensed || !estimator_.surface().touched) {
      held_back_N_ = 0;
      return wanted_N;
    }
    const double missing_N = wanted_N + sample.sensed->head<3>().dot(estimator_.surface().normal);
    held_back_N_ =
        std::clamp(held_back_N_ + kForceLoop_per_s * sample.elapsed_s * missing_N, -kHeldBackMost_N, kHeldBackMost_N);
    return std::max(0.0, wanted_N + held_back_N_);
  }

  double force_N_max_;
  ContactEstimator estimator_;
  double ease_m_ = 0;
  double held_back_N_ = 0;
};

}  // namespace

ArchitectureKind model_mediated() {
  return {.name = "model-mediated",
          .summary = "the robot tells what it touches, the device renders that by itself",
          .needs_sensor = true,
          // Of 300 runs (20 of each of five tasks, 10, 120 and 400 ms) it did 243 with all of it, 257 with half, 229
          // with a sixth, which was spent in contact, and 252 with none, when it waited for the hand in free space.
          .initial_share = 0.5,
          .make = [](const ImpedanceSettings& impedance) { return std::make_unique<ModelMediated>(impedance); }};
}

}  // namespace forcebound::server
