#pragma once

#include <algorithm>
#include <optional>

#include "forcebound/control/audit.hpp"
#include "forcebound/control/energy_sum.hpp"

namespace forcebound::server {

/// What a robot receives of the energy that the law at its leader gave up, and the balance of the robot's own port:
///
///     P_F(t) = integral of (q''D q' + c|q'|) dt + A_F(t) - integral of tau'q' dt  >= -E_0,
///     A_F = s (A_L - A_L at first),    E_0 what the robot's law begins with
///
/// A_L only grows and travels as a sum, so a datagram that is lost, late, doubled or overtaken changes nothing but when
/// the robot hears of it. At once no more is received than the robot keeps at most: the rest is lost, so that no number
/// from a network, however large, makes more of it.
///
/// Real time: noexcept, no allocation.
class ReceivedEnergy {
 public:
  struct Settings {
    double power_scale = 1;  ///< s, what a joule of the leader is worth at the robot; > 0
    double most_J = 2;       ///< that is received at once; > 0
    double initial_J = 0;    ///< E_0, >= 0
  };
  explicit ReceivedEnergy(const Settings& settings) noexcept
      : settings_(settings), port_{.energy_J = settings.initial_J, .minimum_J = settings.initial_J} {}

  /// E_0 [J].
  [[nodiscard]] double initial_J() const noexcept { return settings_.initial_J; }

  /// Another leader: its sum begins with the first that is heard.
  void begin() noexcept { received_J_.reset(); }

  /// What is new, for the robot's law [J].
  [[nodiscard]] double receive(double given_J) noexcept {
    const double before_J = received_J_.value_or(given_J);
    const double more_J = std::min(settings_.power_scale * std::max(0.0, given_J - before_J), settings_.most_J);
    received_J_ = std::max(before_J, given_J);
    sum_.add(more_J);
    return more_J;
  }

  /// A_F [J].
  [[nodiscard]] double received_J() const noexcept { return sum_.value_J(); }

  /// To be called with the robot's own balance on each tick, before what is new since the last one is heard.
  void update(const control::PassivityAudit& robot) noexcept {
    const double given_J = initial_J() + received_J();
    port_.energy_J = robot.energy_J + given_J;
    // Between two ticks A_F stays, so that P_F is least where the robot's own balance is.
    if (robot.minimum_J < robot_minimum_J_) port_.minimum_J = std::min(port_.minimum_J, robot.minimum_J + given_J);
    port_.minimum_J = std::min(port_.minimum_J, port_.energy_J);
    robot_minimum_J_ = std::min(robot_minimum_J_, robot.minimum_J);
  }

  /// P_F + E_0 now and its least. A value below zero is always seen, also between ticks: the robot's own balance is
  /// then below -A_F - E_0, so below all that it was before.
  [[nodiscard]] const control::PassivityAudit& port() const noexcept { return port_; }

 private:
  Settings settings_;
  std::optional<double> received_J_;
  control::EnergySum sum_;
  double robot_minimum_J_ = 0;
  control::PassivityAudit port_;
};

}  // namespace forcebound::server
