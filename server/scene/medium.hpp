#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/server/effects/effect.hpp"
#include "forcebound/server/geometry/point.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// What one probe feels of a medium on one motion.
struct MediumTouch {
  Point force_N = Point::Zero();
  Point normal = Point::UnitX();      ///< unit, out of what is touched
  double penetration_m = 0;           ///< > 0: in contact
  std::uint64_t contacts_left_out = 0;  ///< more than there is room for: what is felt is too soft
  std::uint64_t not_converged = 0;      ///< an iteration ended by its budget: what is felt is its last iterate
  Nanoseconds slipped{0};               ///< simulated time left out, because there was too much to make up for
};

/// What a medium is at a moment: for one client, or for all of a shared scene.
///
/// Real time: `advance` and `touch` are noexcept, allocate nothing and take bounded time. Not thread-safe.
class MediumState {
 public:
  virtual ~MediumState() = default;

  /// A seat for one more probe; its number. There are as many as `Medium::make_state` was told.
  virtual int join() = 0;
  virtual void leave(int seat) = 0;

  /// Lets time pass, > 0, for all probes.
  virtual void advance(Nanoseconds elapsed) noexcept = 0;

  /// The probe is now there (finite).
  [[nodiscard]] virtual MediumTouch touch(int seat, const Point& position_m) noexcept = 0;
};

/// For people and the plan.
struct MediumFacts {
  std::size_t memory_bytes = 0;  ///< shared by all
  std::size_t state_bytes = 0;   ///< of one state, roughly
  double stiffness_N_per_m = 0;  ///< the most that is felt
  double cost_ns = 0;
  Point on_surface_m = Point::Zero();
  std::vector<std::string> lines{};  ///< what it consists of, what it assumes, how near to instability it is
};

/// What moves or deforms by a law of its own: tissue, bodies. Immutable; its states differ.
class Medium {
 public:
  virtual ~Medium() = default;
  [[nodiscard]] virtual std::unique_ptr<MediumState> make_state(int seats) const = 0;
  [[nodiscard]] virtual MediumFacts facts() const = 0;
};

}  // namespace forcebound::server
