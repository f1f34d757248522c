#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "forcebound/local_model/local_model.hpp"
#include "forcebound/scene/effects/effect.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/scene/visible_part.hpp"

namespace forcebound::scene {

/// The force of a dynamic model on one probe.
struct ModelTouch {
  Point force_N = Point::Zero();
  Point normal = Point::UnitX();  ///< unit, out of what is touched
  double penetration_m = 0;       ///< > 0: in contact
};

/// Faults of a dynamic model since it began.
struct DynamicModelFaults {
  std::uint64_t contacts_left_out = 0;  ///< beyond the fixed capacity: the force was too soft
  std::uint64_t not_converged = 0;      ///< steps that ran out of iterations: the last iterate was used
  double slipped_s = 0;                 ///< simulated time skipped because the model was too far behind
};

/// The state of a dynamic model: of one client, or of all clients of a shared scene.
///
/// Real time: `press`, `move`, `advance`, `touch` and `describe` are noexcept, allocate nothing and take bounded time.
/// Not thread-safe.
class DynamicModelState {
 public:
  virtual ~DynamicModelState() = default;

  /// A seat for one more probe; -1 if all seats given to `DynamicModel::make_state` are taken.
  [[nodiscard]] virtual int join() = 0;
  virtual void leave(int seat) = 0;

  /// Sets the position and velocity (both finite) of the probe's device. Over the time that passes next, the device is
  /// taken to have come to this position on a straight line at this velocity.
  virtual void move(int seat, const Point& position_m, const Point& velocity_m_per_s) noexcept = 0;

  /// Sets the buttons of the probe's device, bit k: button k is pressed; as of its next `move`. A seat that was taken
  /// anew has none pressed.
  virtual void press(int seat, std::uint32_t buttons) noexcept {
    (void)seat;
    (void)buttons;
  }

  /// Advances time for all probes; `elapsed_s` >= 0.
  virtual void advance(double elapsed_s) noexcept = 0;

  [[nodiscard]] virtual ModelTouch touch(int seat) noexcept = 0;

  /// A local model of what the probe touches or is near, for its client to render until the next answer; called after
  /// `touch`, before any other probe moves. The force in it is that of `touch`. False, with `model` as it was: there is
  /// none at the moment. The server holds what it says to local_model::is_sound, and sends no model of an answer if one
  /// of it is not.
  [[nodiscard]] virtual bool describe(int seat, local_model::LocalModel& model) noexcept {
    (void)seat;
    (void)model;
    return false;
  }

  /// What can be seen of it, in an order that stays: one surface, or solids.
  [[nodiscard]] virtual std::vector<VisiblePart> visible() const { return {}; }

  /// Where it is now, for a picture: of a surface the vertices, else the solids, from number `first` on, each by its
  /// kNumbersOfVertex or kNumbersOfSolid [m]. @returns how many numbers were written: as many whole ones as fit
  /// Real time.
  [[nodiscard]] virtual std::size_t sample(std::size_t first, std::span<float> to) const noexcept {
    (void)first;
    (void)to;
    return 0;
  }

  /// Whether the state is finite. A state that is not stays so, and must not be used any more.
  [[nodiscard]] virtual bool sound() const noexcept { return true; }

  [[nodiscard]] virtual DynamicModelFaults faults() const noexcept { return {}; }

  /// Copies another state: positions, velocities, probes and history. Two states of one dynamic model then evolve
  /// identically, to the bit; a dynamic model with other parameters continues from the copied state by its own law.
  /// Returns false, with nothing changed, if the other state has another layout, or if copying is not implemented.
  [[nodiscard]] virtual bool copy_from(const DynamicModelState& other) noexcept {
    (void)other;
    return false;
  }
};

/// For the plan and for `--explain`.
struct DynamicModelFacts {
  std::size_t memory_bytes = 0;  ///< shared by all
  std::size_t state_bytes = 0;   ///< of one state, roughly
  double stiffness_N_per_m = 0;  ///< largest stiffness at the device
  double damping_N_s_per_m = 0;  ///< of the coupling to the device
  double age_s = 0;              ///< greatest age of its newest force: it steps at its own rate
  double cost_ns = 0;            ///< estimate, for one motion of a device at 1 kHz, without a local model
  double describe_cost_ns = 0;   ///< estimate, for the local model of one answer; 0: hardly any
  /// Where a device first meets it: some point of a surface that a probe can reach; where devices drag a body, the
  /// point of the first one.
  Point on_surface_m = Point::Zero();
  Eigen::AlignedBox3d bounds_m{};  ///< of tissue at the start; empty: not known
  int seats_max = std::numeric_limits<int>::max();
  bool describes_itself = false;     ///< its states give local models
  Inputs inputs{};                   ///< beside the position: velocity of `move`, time of `advance`
  std::vector<std::string> lines{};  ///< its parts, its assumptions, its margin of stability
};

/// A model with dynamics of its own: tissue, bodies. Immutable; what changes is in its states.
class DynamicModel {
 public:
  virtual ~DynamicModel() = default;

  /// @param seats from 1 to DynamicModelFacts::seats_max
  [[nodiscard]] virtual std::unique_ptr<DynamicModelState> make_state(int seats) const = 0;
  [[nodiscard]] virtual DynamicModelFacts facts() const = 0;
};

}  // namespace forcebound::scene
