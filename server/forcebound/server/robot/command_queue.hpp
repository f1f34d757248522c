#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// The commands of a simulated robot: each takes effect the facts' latency after it was given, and is released the hold
/// time after that. Where more than 256 wait, the newest replaces the one before it.
///
/// Times are since the robot's start. Real time: noexcept, no allocation.
class CommandQueue {
 public:
  /// @param facts with a release in one stage
  explicit CommandQueue(const control::DeviceFacts& facts) noexcept;

  void command(Nanoseconds now, const Vector& torque) noexcept;

  /// Zero torque at once, and nothing more on its way.
  void drop(Nanoseconds now) noexcept;

  /// The next change after `now`, or `latest`.
  [[nodiscard]] Nanoseconds next_change(Nanoseconds now, Nanoseconds latest) const noexcept;

  /// All changes up to `now`.
  void pass(Nanoseconds now) noexcept;

  /// In effect.
  [[nodiscard]] const Vector& torque() const noexcept { return torque_; }

  /// When the last command was released; none: it is still held, or on its way.
  [[nodiscard]] std::optional<Nanoseconds> released() const noexcept { return released_; }

 private:
  static constexpr std::size_t kWaitingMax = 256;
  struct Command {
    Nanoseconds effect{0};
    Vector torque;
  };

  Nanoseconds latency_;
  Nanoseconds hold_;
  std::array<Command, kWaitingMax> waiting_;
  std::size_t count_ = 0;
  Vector torque_;
  std::optional<Nanoseconds> release_;
  std::optional<Nanoseconds> released_;
};

}  // namespace forcebound::server
