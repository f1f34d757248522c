#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/commands/identify/guide.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::lab::identification {

/// What identification made of a device whose facts nobody had told it.
struct StudyDevice {
  std::uint64_t seed = 0;
  std::string kind;
  bool complete = false;
  std::vector<std::string> refusals{};
  std::vector<double> damping_share{};       ///< bound over truth of each joint, 0 where refused
  std::vector<double> friction_share{};      ///< of each joint that has friction
  int bounds = 0;                            ///< lower bounds of damping and friction that were written
  int above = 0;                             ///< of them above the truth
  bool wrong_step = false;                   ///< of an encoder
  bool wrong_gain = false;                   ///< of a motor
  std::vector<double> gain_doubt{};          ///< half the width of each motor's bracket
  std::optional<double> latency_excess_s{};  ///< upper bound less truth; none: refused
  std::optional<double> hold_excess_s{};
  bool time_outside = false;                ///< a time is not within its bounds
  double seconds = 0;                       ///< that it took
  std::optional<double> least_P_J{};        ///< of fba-exact with these facts, against a hostile environment
  std::optional<double> stiffness_share{};  ///< displayed with these facts over that with the true ones

  [[nodiscard]] bool any_outside() const noexcept { return time_outside || wrong_step || wrong_gain; }
};

struct StudySettings {
  std::uint64_t devices = 500;
  std::uint64_t seed = 1;
  double confidence = 0.99;
  bool law = true;  ///< play fba-exact with the facts too
  client::commands::identify::GuideSettings guide{};
};

/// One device, identified in virtual time.
[[nodiscard]] StudyDevice study_device(std::uint64_t seed, const StudySettings& settings);

[[nodiscard]] std::vector<StudyDevice> study_devices(const StudySettings& settings,
                                                     const std::function<void(std::uint64_t done)>& progress);

/// A row for each kind of device.
[[nodiscard]] std::string study_text(const std::vector<StudyDevice>& devices, text::Colour colour);

/// A row for each device.
[[nodiscard]] std::string study_csv(const std::vector<StudyDevice>& devices);

/// Whether any written bound is wrong, or the law with these facts was not passive.
[[nodiscard]] bool any_wrong(const std::vector<StudyDevice>& devices) noexcept;

}  // namespace forcebound::lab::identification
