#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/results/laws_figure.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace CLI {
class App;
}

namespace forcebound::lab {

/// One scene, device, hand and network for several laws and renderings, each in a run of its own, in virtual time.
struct TrialsSettings {
  std::string scene;    ///< name or file
  std::string device;   ///< name or file
  std::string hand;     ///< the operator's specification
  std::string network;  ///< both ways: netem's words, "none", or "trace:FILE"
  std::vector<std::string> laws;
  std::vector<std::string> renderings{"local", "remote"};  ///< of these two
  double duration_s = 12;
  std::uint64_t seed = 1;
};

/// Results of one law with one rendering.
struct PlayedTrial {
  std::string law;
  std::string rendering{};  ///< "no network", "remote" or "local"
  std::string refused{};    ///< why the law cannot work with this device; otherwise empty, and the rest is known
  nlohmann::ordered_json summary{};                ///< as the client's --summary writes it
  std::optional<double> ringing_s{};               ///< after the first contact; nothing without one
  std::optional<double> rotational_N_m_per_rad{};  ///< displayed stiffness (RotationalStiffness)
  double push_N = 0;  ///< the largest force along the device's own motion: pushing, not resisting
  /// Root mean square of the applied force's difference from that of the same law without a network, over the latter's;
  /// nothing where that was not played, or felt no force.
  std::optional<double> off_by{};
};

/// Each law without a network, where the settings have one, and then with each rendering through it.
///
/// @param figure may be null; otherwise it gets the curves of all
/// @param progress called with the share done, 0 to 1
/// @throws what device, hand, law, scene and network refuse
[[nodiscard]] std::vector<PlayedTrial> play_trials(const TrialsSettings& settings, results::LawsFigure* figure,
                                                   const std::function<void(double)>& progress);

/// The table of results, in SI with fixed digits and 80 columns; P below zero in red.
[[nodiscard]] std::string trials_table(const TrialsSettings& settings, const std::vector<PlayedTrial>& trials,
                                       text::Colour colour);

/// The timing of live runs, which depends on machine and network: period, late ticks, round trip.
/// @param summaries as the client's --summary writes them
[[nodiscard]] std::string timing_table(const std::vector<nlohmann::ordered_json>& summaries);

/// The command `trials`.
void add_trials(CLI::App& app);

}  // namespace forcebound::lab
