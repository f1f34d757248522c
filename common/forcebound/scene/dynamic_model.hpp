#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/scene/effects/effect.hpp"
#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// What one probe feels of a dynamic model.
struct ModelTouch {
  Point force_N = Point::Zero();
  Point normal = Point::UnitX();  ///< unit, out of what is touched
  double penetration_m = 0;       ///< > 0: in contact
};

/// What went wrong in a dynamic model since it began.
struct DynamicModelFaults {
  std::uint64_t contacts_left_out = 0;  ///< more than there was room for: what was felt was too soft
  std::uint64_t not_converged = 0;      ///< iterations that their budget ended: their last iterate was felt
  double slipped_s = 0;                 ///< simulated time left out, because there was too much to make up for
};

/// What a dynamic model is at a moment: for one client, or for all of a shared scene.
///
/// Real time: `move`, `advance` and `touch` are noexcept, allocate nothing and take bounded time. Not thread-safe.
class DynamicModelState {
 public:
  virtual ~DynamicModelState() = default;

  /// A seat for one more probe; none (-1) if there are as many as `DynamicModel::make_state` was told.
  [[nodiscard]] virtual int join() = 0;
  virtual void leave(int seat) = 0;

  /// The probe's device is now there, and came with that velocity (both finite): on the straight way that the velocity
  /// gives, over the time that passes next.
  virtual void move(int seat, const Point& position_m, const Point& velocity_m_per_s) noexcept = 0;

  /// Time passes for all probes, >= 0.
  virtual void advance(double elapsed_s) noexcept = 0;

  [[nodiscard]] virtual ModelTouch touch(int seat) noexcept = 0;

  /// Whether the state is still one of numbers. If not it stays so, and is not to be asked any more.
  [[nodiscard]] virtual bool sound() const noexcept { return true; }

  [[nodiscard]] virtual DynamicModelFaults faults() const noexcept { return {}; }

  /// Goes on from where another state is: its places, velocities and probes, and what it remembers. Two of one dynamic
  /// model then do the same, to the bit; one of a dynamic model that is set up otherwise does what that makes of it.
  /// False, with nothing changed, if the other is of another shape, or if that cannot be done here.
  [[nodiscard]] virtual bool copy_from(const DynamicModelState& other) noexcept {
    (void)other;
    return false;
  }
};

/// For people and the plan.
struct DynamicModelFacts {
  std::size_t memory_bytes = 0;  ///< shared by all
  std::size_t state_bytes = 0;   ///< of one state, roughly
  double stiffness_N_per_m = 0;  ///< the most that is felt
  double damping_N_s_per_m = 0;  ///< of what ties the device to it
  double age_s = 0;              ///< of its newest force, at most: it steps at a rate of its own
  double cost_ns = 0;            ///< for one motion of a device at 1 kHz, roughly
  /// Where a device meets it as it begins: some point of a surface that a probe can reach; where devices drag a body,
  /// the point at which the first one does.
  Point on_surface_m = Point::Zero();
  Eigen::AlignedBox3d bounds_m{};  ///< of tissue as it begins; empty: not known
  int seats_max = std::numeric_limits<int>::max();
  Inputs inputs{};                   ///< beside the position: velocity of `move`, time of `advance`
  std::vector<std::string> lines{};  ///< what it consists of, what it assumes, how near to instability it is
};

/// What moves or deforms by a law of its own: tissue, bodies. Immutable; its states differ.
class DynamicModel {
 public:
  virtual ~DynamicModel() = default;

  /// @param seats from 1 to DynamicModelFacts::seats_max
  [[nodiscard]] virtual std::unique_ptr<DynamicModelState> make_state(int seats) const = 0;
  [[nodiscard]] virtual DynamicModelFacts facts() const = 0;
};

}  // namespace forcebound::scene
