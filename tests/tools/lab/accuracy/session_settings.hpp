#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "forcebound/client/session/late_force_policy.hpp"

namespace forcebound::lab {

/// Settings between a scene's forces and the device, besides the network.
struct SessionSettings {
  std::string law = "fba-exact";
  client::LateForcePolicy policy{};
  double server_rate_Hz = kEveryMotion_Hz;  ///< most answers per second; a step may take longer
  bool renders_locally = false;             ///< what can be at the client

  /// One for each motion.
  static constexpr double kEveryMotion_Hz = 1000;

  /// Least time of the server's turn [s]: 0 where it may answer every motion.
  [[nodiscard]] double server_turn_least_s() const noexcept {
    return server_rate_Hz < kEveryMotion_Hz ? 1 / server_rate_Hz : 0;
  }
};

/// "law", "hold_ms", "drop_ms", "rate_Hz" and "rendering": the keys of a session that a sweep may change. Keys of
/// scenes have a dot.
[[nodiscard]] const std::vector<std::string>& session_keys();

[[nodiscard]] bool is_session_key(std::string_view key);

/// With another value for one of these keys; the name of a law may be in quotes.
/// @throws std::invalid_argument "hold_ms must be ..., got ..."
[[nodiscard]] SessionSettings with_session_key(SessionSettings session, const std::string& key,
                                               const std::string& value);

/// For people: "law fba-exact, hold 250 ms, drop 1000 ms, the server answers at most 1000 motions a second,
/// rendering remote".
[[nodiscard]] std::string to_text(const SessionSettings& session);

}  // namespace forcebound::lab
