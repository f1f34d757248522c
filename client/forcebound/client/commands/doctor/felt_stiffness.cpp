#include "forcebound/client/commands/doctor/felt_stiffness.hpp"

#include <algorithm>

namespace forcebound::client::commands {

std::span<const FeltClass> felt_classes() noexcept {
  static constexpr std::array kClasses{
      FeltClass{"static", "walls, shapes, meshes, friction", {1, 0.225, 0.042, 0.002}, {1, 1, 1, 1}},
      FeltClass{"tissue", "tissue that is pressed or stroked", {1, 0.955, 0.348, 0.091}, {1, 1, 1, 1}},
      FeltClass{"body", "a body that only the hand moves", {1, 0.917, -0.247, -0.776}, {1, 0.916, 0.998, 1.001}},
      FeltClass{"body-at-stop", "a body pushed against a stop", {1, 0.98, 0.329, 0.039}, {1, 1, 1, 1}}};
  return kClasses;
}

double felt_share(std::span<const double, FeltClass::kBehind_ms.size()> shares, double round_trip_ms) noexcept {
  const auto& behind_ms = FeltClass::kBehind_ms;
  const double at_ms = std::clamp(round_trip_ms, behind_ms.front(), behind_ms.back());
  std::size_t next = 1;
  while (next + 1 < behind_ms.size() && at_ms > behind_ms[next]) ++next;
  const double part = (at_ms - behind_ms[next - 1]) / (behind_ms[next] - behind_ms[next - 1]);
  return shares[next - 1] + part * (shares[next] - shares[next - 1]);
}

}  // namespace forcebound::client::commands
