#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/commands/identify/energy_balance.hpp"
#include "forcebound/client/commands/identify/guide.hpp"
#include "forcebound/control/device_facts.hpp"

namespace forcebound::client::commands::identify {

/// A time that is known to lie between two bounds. Refused: it does not, and why.
struct TimeBounds {
  double least_s = 0;
  double most_s = 0;
  std::string refused{};
};

/// What somebody knows of the device's inertia: the mass that a joint seems to have, from its motor's commands, tells
/// what the motor makes of them.
struct KnownMass {
  std::vector<double> of_joints{};  ///< of each: [kg], or [kg m^2] where it turns; none: not known
  double share = 0;                 ///< each is within this share of that
};

/// What is known of one joint, all in units of its motor's commands.
struct JointFindings {
  double encoder_step = 0;
  std::string encoder_refused{};
  double break_away = 0;
  EnergyBalance balance{};
  control::Bracket gain_share{};        ///< the motor makes what is commanded, and so much more
  std::optional<ReleaseFit> release{};  ///< the same by free decay
  std::vector<SlidePoint> points{};
};

/// What a guide's slides say of the device.
struct Findings {
  std::vector<JointFindings> joints{};
  TimeBounds latency{};
  TimeBounds hold{};
  bool releases = true;
  bool gains_measured = false;  ///< else as the driver says
  ReadingFacts readings{};
  double force_N_most = 0;  ///< the largest that was commanded
  std::string trouble{};    ///< why it ended early

  /// Whether every fact has been established that a law needs.
  [[nodiscard]] bool complete() const noexcept;
  /// The gains of all motors as facts say it. That of a single one divides all energies alike, and so does not matter.
  [[nodiscard]] control::Bracket torque_gain_share() const noexcept;
  /// Each refusal in a line: "friction of axis 2: ...".
  [[nodiscard]] std::vector<std::string> refusals(bool cartesian) const;
};

/// @param confidence that all bounds hold, together
[[nodiscard]] Findings evaluate(const Guide& guide, const control::DeviceFacts& declared, double confidence,
                                const KnownMass& known = {});

/// What a law may rely on: what was found, and of the rest what was declared (largest force, period, uncertainties that
/// no motion tells). Only if complete.
[[nodiscard]] control::DeviceFacts facts_of(const Findings& findings, const control::DeviceFacts& declared);

}  // namespace forcebound::client::commands::identify
