#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/control/held_force.hpp"

namespace forcebound::baselines {
namespace {

struct Augmentation {
  double feedback_share = 1;
  double increment_m = 0;
  double rest_m_per_s = 0;
};

/// Successive force augmentation [Singh et al. 2019]: a soft spring that is stable at any rate, and on top of it an
/// offset that grows, while the hand presses, until the wall shows the stiffness that was wanted.
///
/// Along u = f_e/|f_e|, device frame; p penetration [m], F force against it [N], our f = F u:
///
///     F = k p + offset,   k = share b_u/T,   b_u = 1/(u'b^-1 u)
///     pressing   offset moves by at most an increment (k times 0.2 um) each tick, until F/p = K
///     releasing  the same line, offset as it is
///     contact over (f_e = 0)  offset = 0
///
/// The loop around k is stable whatever the offset does, as the offset does not follow the motion. But energy is not
/// bounded: releasing runs along a line above that of pressing and returns up to (K - k) p^2 more than pressing stored.
/// Passivity is not guaranteed.
///
/// Built from a description of the approach; our decisions:
/// - **p and K** are not known to a law. F/p = K says the same as F = |f_e|, as |f_e| = K p; and of p only its changes
///   count, -u'd, as the offset takes in what is constant. So the offset grows until F = |f_e|. In the first tick of a
///   contact p is the last step against u, the most it can be, and F no more than asked for.
/// - **What is softer than k** is shown as it is: the spring is k, but no more than the stiffness that the environment
///   has shown in this contact, the largest |change of f_e| over the largest step of the last ticks. To cut F at |f_e|
///   instead would lose a step of an encoder with each late answer. Pressed above |f_e|, the offset falls again.
/// - **The largest force** of the device cuts F, and the line goes on from there.
/// - **A device at rest counts as pressed** while F is below |f_e|, and "at rest" means yielding to the offset no
///   faster than `rest_m_per_s`. Else a hand that holds still would never feel the wall.
/// - **Another contact** begins where u turns by more than a right angle.
///
/// A lost reading ends the contact. No clock is asked for, so one that stands still does no harm.
/// Real time: noexcept, no allocation, O(dof^2).
class SuccessiveForceAugment final : public control::PassivityLaw {
 public:
  SuccessiveForceAugment(const control::DeviceFacts& facts, const Augmentation& augmentation)
      : held_(facts.degrees_of_freedom(), facts.period_s),
        augmentation_(augmentation),
        force_N_max_(facts.force_N_max) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "sfa"; }

  void credit(const control::Motion& motion) noexcept override {
    const auto d = held_.displacement(motion);
    displacement_ = d ? *d : Vector::Zero(motion.position.rows());
    held_.begin(motion);
    steps_[next_step_] = displacement_.norm();
    next_step_ = (next_step_ + 1) % kTicks;
    // A step that overflows is a fault of the device.
    if (!displacement_.allFinite()) leave();
  }

  void lose(const control::Motion& /*motion*/) noexcept override {
    held_.lose();
    leave();
  }

  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override {
    if (request_N.isZero(0) || !held_.known() || !displacement_.allFinite()) {
      leave();
      return Vector::Zero(request_N.rows());
    }
    const Vector normal = request_N.stableNormalized();
    const double wanted_N = request_N.stableNorm();
    const double pressed_m = -normal.dot(displacement_);
    update_shown_stiffness(wanted_N);
    if (spring_N_per_m_ > 0 && normal.dot(normal_) > 0) {
      follow(pressed_m, wanted_N);
    } else {
      spring_N_per_m_ = augmentation_.feedback_share / (4 * held_.reserve_J(normal));
      force_N_ = std::min(spring_N_per_m_ * std::max(0.0, pressed_m), wanted_N);
    }
    normal_ = normal;
    // Exactly the request, to the last bit, where all of it is applied.
    return force_N_ == wanted_N ? request_N : Vector(force_N_ * normal);
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// None: the law keeps no ledger.
  [[nodiscard]] double energy_J() const noexcept override { return 0; }

 private:
  static constexpr std::size_t kTicks = 4;      // within which a request may be due to a step
  static constexpr double kStepLeast_m = 1e-9;  // shorter steps give no estimate of stiffness

  void leave() noexcept {
    spring_N_per_m_ = 0;
    shown_N_per_m_ = 0;
    wanted_N_ = 0;
    force_N_ = 0;
  }

  void update_shown_stiffness(double wanted_N) noexcept {
    const double moved_m = *std::ranges::max_element(steps_);
    if (moved_m > kStepLeast_m) {
      shown_N_per_m_ = std::max(shown_N_per_m_, std::abs(wanted_N - wanted_N_) / moved_m);
    }
    wanted_N_ = wanted_N;
  }

  void follow(double pressed_m, double wanted_N) noexcept {
    const double before_N = force_N_;
    const double increment_N = spring_N_per_m_ * augmentation_.increment_m;
    const bool releasing = pressed_m < -augmentation_.rest_m_per_s * held_.period_s();
    force_N_ = std::max(0.0, before_N + std::min(spring_N_per_m_, shown_N_per_m_) * pressed_m);
    if (force_N_ < wanted_N && !releasing) {
      force_N_ = std::min(force_N_ + increment_N, wanted_N);
    } else if (force_N_ > wanted_N && pressed_m > 0) {
      force_N_ = std::max({force_N_ - increment_N, wanted_N, before_N});
    }
    force_N_ = std::min(force_N_, force_N_max_);
  }

  control::HeldForce held_;
  Augmentation augmentation_;
  double force_N_max_;
  Vector displacement_;
  Vector normal_;
  std::array<double, kTicks> steps_{};  // of the device [m]
  std::size_t next_step_ = 0;
  double spring_N_per_m_ = 0;  // k; 0: no contact
  double shown_N_per_m_ = 0;   // largest shown by the environment in this contact
  double wanted_N_ = 0;
  double force_N_ = 0;  // F
};

}  // namespace

control::LawDescription successive_force_augment() {
  return {.name = "sfa",
          .summary = "successive force augmentation: a soft spring and an offset that grows while the hand presses",
          .reference = "Singh et al. 2019",
          .certainty = control::LawCertainty::reconstruction,
          .parameters = {{.name = "feedback_share",
                          .purpose = "stiffness of the spring, k, as a share of b/T",
                          .least = 1e-6,
                          .most = 1e3,
                          .standard = [](const control::DeviceFacts&) { return 1.0; }},
                         {.name = "increment_m",
                          .purpose = "growth of the offset per tick, as a compression of the spring",
                          .most = 1,
                          .standard = [](const control::DeviceFacts&) { return 2e-7; }},
                         {.name = "rest_m_per_s",
                          .purpose = "slower backward motion does not count as release",
                          .most = 10,
                          .standard = [](const control::DeviceFacts&) { return 0.003; }}},
          .make = [](const control::DeviceFacts& facts,
                     const control::LawOptions& options) -> std::unique_ptr<control::PassivityLaw> {
            require_translations("sfa", facts);
            const Augmentation augmentation{.feedback_share = options.parameters.at("feedback_share"),
                                            .increment_m = options.parameters.at("increment_m"),
                                            .rest_m_per_s = options.parameters.at("rest_m_per_s")};
            return std::make_unique<SuccessiveForceAugment>(facts, augmentation);
          }};
}

}  // namespace forcebound::baselines
