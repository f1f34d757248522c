#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "forcebound/device/kinematics/kinematics.hpp"
#include "forcebound/record/tick_record.hpp"
#include "tests/tools/reference/reference_exact.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// Recomputes the energy that a law may spend, in long double, from a run's record alone. Shares no code with the laws.
class LedgerInLongDouble {
 public:
  /// None where the record does not suffice: fba-more; encoder steps, a coupled damping matrix or an unknown time of
  /// choosing for fba-exact; an arm for the others.
  [[nodiscard]] static std::unique_ptr<LedgerInLongDouble> make(const sim::ClosedLoop::Settings& settings);

  /// After this tick's motion [J]. To be called for each tick in turn.
  long double energy_J(const record::TickRecord& tick);

 private:
  struct Command {
    time::Nanoseconds effect{0};
    control::Vector torque;
  };
  using Pieces = std::vector<std::vector<test::ForcePiece>>;  // for each joint

  explicit LedgerInLongDouble(const sim::ClosedLoop::Settings& settings);

  [[nodiscard]] control::Matrix jacobian(const control::Vector& joint) const;
  [[nodiscard]] Pieces pieces(time::Nanoseconds begin, time::Nanoseconds end) const;
  [[nodiscard]] long double reserve_J(std::size_t joint, long double torque, long double duration_s) const;
  void credit_exactly(const record::TickRecord& tick);
  void credit_as_published(const record::TickRecord& tick);
  [[nodiscard]] long double taken_until_next_J(const record::TickRecord& tick) const;
  [[nodiscard]] long double most_J(const control::Vector& joint) const;

  device::DeviceDescription device_;
  std::unique_ptr<const device::Kinematics> kinematics_;
  bool exact_;
  bool capped_;
  time::Nanoseconds latency_;
  time::Nanoseconds hold_;
  std::optional<record::TickRecord> before_;
  std::deque<Command> commands_;  // the one in effect, and those on their way
  long double energy_J_ = 0;
};

}  // namespace forcebound::lab
