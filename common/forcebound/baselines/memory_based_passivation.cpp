#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/control/held_force.hpp"

namespace forcebound::baselines {
namespace {

/// The path of pressing: forces held, by how deep the device was. Bounded; where it is full, the two neighbours that
/// differ least become one with the smaller force, which only forgets energy.
class PressingPath {
 public:
  void clear() noexcept { count_ = 0; }

  void add(double length_m, double force_N) noexcept {
    if (count_ == stretches_.size()) merge();
    stretches_[count_++] = {length_m, force_N};
  }

  /// The least force remembered over the deepest `length_m`, of the top if that is none; beyond the path 0.
  [[nodiscard]] double least_force_N(double length_m) const noexcept {
    double least_N = count_ > 0 ? stretches_[count_ - 1].force_N : 0.0;
    for (std::size_t i = count_; length_m > kLengthLeast_m; --i) {
      if (i == 0) return 0;
      least_N = std::min(least_N, stretches_[i - 1].force_N);
      length_m -= stretches_[i - 1].length_m;
    }
    return least_N;
  }

  [[nodiscard]] double energy_J() const noexcept {
    double energy_J = 0;
    for (std::size_t i = 0; i < count_; ++i) energy_J += stretches_[i].length_m * stretches_[i].force_N;
    return std::min(energy_J, std::numeric_limits<double>::max());
  }

  void remove_deepest(double length_m) noexcept {
    while (count_ > 0 && length_m > kLengthLeast_m) {
      Stretch& top = stretches_[count_ - 1];
      if (top.length_m > length_m) {
        top.length_m -= length_m;
        return;
      }
      length_m -= top.length_m;
      --count_;
    }
  }

 private:
  struct Stretch {
    double length_m = 0;
    double force_N = 0;
  };

  /// What becoming one with the next would forget [J].
  [[nodiscard]] double merging_J(std::size_t i) const noexcept {
    const Stretch& low = stretches_[i];
    const Stretch& high = stretches_[i + 1];
    const Stretch& stronger = low.force_N > high.force_N ? low : high;
    return std::abs(high.force_N - low.force_N) * stronger.length_m;
  }

  void merge() noexcept {
    std::size_t cheapest = 0;
    double least_J = merging_J(0);
    for (std::size_t i = 1; i + 1 < count_; ++i) {
      const double forgotten_J = merging_J(i);
      if (forgotten_J >= least_J) continue;
      least_J = forgotten_J;
      cheapest = i;
    }
    Stretch& kept = stretches_[cheapest];
    const Stretch& next = stretches_[cheapest + 1];
    kept = {kept.length_m + next.length_m, std::min(kept.force_N, next.force_N)};
    const auto gone = stretches_.begin() + static_cast<std::ptrdiff_t>(cheapest) + 1;
    std::move(gone + 1, stretches_.begin() + static_cast<std::ptrdiff_t>(count_), gone);
    --count_;
  }

  static constexpr double kLengthLeast_m = 1e-12;  // less is rounding, and must not reach into the next stretch
  std::array<Stretch, 256> stretches_;
  std::size_t count_ = 0;
};

/// Memory-based passivation [Ryu, Yoon 2014]: in the plane of position and force the path of releasing is kept below
/// the path of pressing, so that a contact returns no more than was put into it.
///
/// Along u = f_e/|f_e|, device frame; s depth [m], our f = F u. While pressing, F = |f_e|, and what was held is
/// remembered by depth: F_{n-1} from s_{n-1} to s_n. While releasing
///
///     F = min(|f_e|, the least force remembered between s_n and the depth expected next, s_n + (s_n - s_{n-1}))
///
/// and zero beyond the start of the path. The part of the path that was released over is dropped. The device's damping
/// is neither relied on nor used up.
///
/// A reconstruction from the published idea; our decisions:
/// - **Depth** is the way against u, s_n = s_{n-1} - u_{n-1}'d_n, so that on a curved surface F times its change is the
///   energy. A new path begins where u turns by more than a right angle, and after the contact.
/// - **Expected** is a step like the last nonzero one: at rest, and between two steps of an encoder, the last step
///   continues. When the device reverses, which no extrapolation foresees, the force of one step is a step's worth too
///   large. Repaying that from the next release was tried, and made contacts ring.
/// - **No force without pressing**: an object that moves into a device at rest is felt once the device moves into it.
/// - **Time** matters only here: an interval that no clock measured, a force that the device dropped, and a lost
///   reading each end the path.
///
/// Pressing is not bounded. A device that reaches a wall within one tick and is pushed back within the next returns
/// energy that it never stored, and only its damping can dissipate it: passivity is not guaranteed, and a light hand
/// bounces on stiff walls.
///
/// Real time: noexcept, no allocation, O(dof^2 + 256).
class MemoryBasedPassivation final : public control::PassivityLaw {
 public:
  explicit MemoryBasedPassivation(const control::DeviceFacts& facts)
      : held_(facts.degrees_of_freedom(), facts.period_s) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "mbpa"; }

  void credit(const control::Motion& motion) noexcept override {
    if (!control::is_measurable(motion.interval_s) || motion.held_s < motion.interval_s) lose(motion);
    const auto d = held_.displacement(motion);
    displacement_ = d ? *d : Vector::Zero(motion.position.rows());
    update_path();
    held_.begin(motion);
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
    if (normal_.rows() > 0 && normal.dot(normal_) <= 0) leave();
    normal_ = normal;
    const double pressed_m = -normal.dot(displacement_);
    if (pressed_m != 0) expected_m_ = pressed_m;
    if (expected_m_ > 0) return request_N;
    const double most_N = path_.least_force_N(-expected_m_);
    return most_N >= request_N.stableNorm() ? request_N : Vector(most_N * normal);
  }

  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }

  /// Energy that pressing stored and that was not released yet [J].
  [[nodiscard]] double energy_J() const noexcept override { return path_.energy_J(); }

 private:
  void leave() noexcept {
    path_.clear();
    normal_.resize(0);
    expected_m_ = 0;
  }

  /// Adds what was pressed to the path, or removes what was released, in the interval that ended.
  void update_path() noexcept {
    if (normal_.rows() == 0) return;
    const double pressed_m = -normal_.dot(displacement_);
    const double force_N = std::max(0.0, held_.force().dot(normal_));
    if (!std::isfinite(force_N * pressed_m)) {
      leave();
    } else if (pressed_m > 0) {
      path_.add(pressed_m, force_N);
    } else {
      path_.remove_deepest(-pressed_m);
    }
  }

  control::HeldForce held_;
  PressingPath path_;
  Vector displacement_;
  Vector normal_;          // no rows: no contact
  double expected_m_ = 0;  // change of depth of the next step
};

}  // namespace

control::LawDescription memory_based_passivation() {
  return {.name = "mbpa",
          .summary = "memory-based passivation: releasing stays below the remembered path of pressing",
          .reference = "Ryu, Yoon 2014",
          .certainty = control::LawCertainty::reconstruction,
          .make = [](const control::DeviceFacts& facts,
                     const control::LawOptions& /*options*/) -> std::unique_ptr<control::PassivityLaw> {
            require_translations("mbpa", facts);
            return std::make_unique<MemoryBasedPassivation>(facts);
          }};
}

}  // namespace forcebound::baselines
