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

/// What is known of one joint.
struct JointFindings {
  double encoder_step = 0;
  std::string encoder_refused{};
  double break_away = 0;
  EnergyBalance balance{};
  std::optional<ReleaseFit> release{};  ///< the same by free decay
  std::vector<SlidePoint> points{};
};

/// What a guide's slides say of the device.
struct Findings {
  std::vector<JointFindings> joints{};
  TimeBounds latency{};
  TimeBounds hold{};
  bool releases = true;
  ReadingFacts readings{};
  double force_N_most = 0;  ///< the largest that was commanded
  std::string trouble{};    ///< why it ended early

  /// Whether every fact has been established that a law needs.
  [[nodiscard]] bool complete() const noexcept;
  /// Each refusal in a line: "friction of axis 2: ...".
  [[nodiscard]] std::vector<std::string> refusals(bool cartesian) const;
};

/// @param confidence that all bounds hold, together
[[nodiscard]] Findings evaluate(const Guide& guide, const control::DeviceFacts& declared, double confidence);

/// What a law may rely on: what was found, and of the rest what was declared (largest force, period, uncertainties that
/// no motion tells). Only if complete.
[[nodiscard]] control::DeviceFacts facts_of(const Findings& findings, const control::DeviceFacts& declared);

}  // namespace forcebound::client::commands::identify
