#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/page/request.hpp"

namespace forcebound::client {

/// A law that can be chosen.
struct LawChoice {
  std::string name;
  std::string about;
};

/// A setting that can be chosen, with its values in JSON Schema.
struct Setting {
  std::string_view name;
  std::string_view schema;
};

inline constexpr std::array<Setting, 6> kSettings{{
    {"law", R"({"type":"string"})"},
    {"law_beside", R"({"type":["string","null"]})"},
    {"scene", R"({"type":["string","null"]})"},
    {"device", R"({"type":"string"})"},
    {"stiffness_N_per_m", R"({"type":"number"})"},
    {"network", R"({"type":"object","properties":{"delay_ms":{"type":"number"},"jitter_ms":{"type":"number"},)"
                R"("loss_percent":{"type":"number"}},"required":["delay_ms","jitter_ms","loss_percent"]})"},
}};

/// What can be chosen on a page; a list that is empty: that cannot be chosen.
struct PageChoices {
  std::vector<LawChoice> laws{};
  std::vector<std::string> scenes{};
  std::vector<std::string> devices{};
  bool beside = false;     ///< a second law may run beside
  bool stiffness = false;  ///< of the hand
};

/// What a page shows as chosen.
struct PageChoice {
  std::string law;
  std::optional<std::string> law_beside{};  ///< none: there is no second client
  std::string scene{};                      ///< empty: the server's default
  std::string device{};
  std::optional<double> stiffness_N_per_m{};  ///< of the simulated hand
  bool recording = false;

  friend bool operator==(const PageChoice&, const PageChoice&) = default;
};

/// The stiffness that a hand may be given [N/m].
inline constexpr double kHandStiffnessLeast = 10;
inline constexpr double kHandStiffnessMost = 5000;

/// What a viewer's choice makes of it.
/// @throws std::invalid_argument with the value and what would be accepted
[[nodiscard]] PageChoice changed(const PageChoice& now, const page::Choose& choice, const PageChoices& choices);

/// A recording that is played.
struct Replay {
  std::string file;
  double duration_s = 0;
  bool playing = true;
  double speed = 1;
};

/// What a page is told about a program and its run.
struct PageState {
  PageChoices choices{};
  PageChoice choice{};
  std::optional<page::Network> network{};  ///< none: there is no relay to tell
  bool simulated = false;                  ///< device and hand are
  bool pointer = false;                    ///< the hand follows a pointer
  int degrees_of_freedom = 3;              ///< shown: 1 to 3
  double period_s = 1e-3;
  std::string recording_file{};
  std::optional<Replay> replay{};  ///< in place of a run
};

/// The message `hello`.
[[nodiscard]] std::string hello_message(const PageState& state, double time_s);

/// The messages `event` and `refused`.
[[nodiscard]] std::string event_message(int track, double time_s, const std::string& level, const std::string& text);
[[nodiscard]] std::string refused_message(const std::string& about, const std::string& text);

}  // namespace forcebound::client
