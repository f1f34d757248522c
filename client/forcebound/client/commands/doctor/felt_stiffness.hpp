#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace forcebound::client::commands {

/// What a class of scenes displays of its stiffness behind a network, of what it displays without one: medians of runs
/// of fba-exact behind that round trip with 10 % of jitter and 5 % of loss, the worst of the class, from
/// deploy/rendering-results.json (client/README.md, "What a hand feels"). A test compares them.
struct FeltClass {
  static constexpr std::array<double, 4> kBehind_ms{0, 20, 100, 200};

  const char* name;
  const char* words;  ///< what it is, for people
  std::array<double, kBehind_ms.size()> at_server;
  std::array<double, kBehind_ms.size()> at_client;  ///< local rendering: static parts, or local models
};

[[nodiscard]] std::span<const FeltClass> felt_classes() noexcept;

/// The displayed share behind a round trip, in a straight line between those measured; beyond them that of the
/// longest. Below zero nothing is left: the force pushes instead of resisting.
[[nodiscard]] double felt_share(std::span<const double, FeltClass::kBehind_ms.size()> shares,
                                double round_trip_ms) noexcept;

}  // namespace forcebound::client::commands
