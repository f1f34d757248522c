#include "forcebound/server/offer/environment.hpp"

#include <algorithm>

namespace forcebound::server {

bool EnvironmentKind::accepts(std::uint32_t device_degrees_of_freedom) const noexcept {
  if (device_degrees_of_freedom < 1 || device_degrees_of_freedom > control::kDofMax) return false;
  return degrees_of_freedom.empty() ||
         std::ranges::find(degrees_of_freedom, device_degrees_of_freedom) != degrees_of_freedom.end();
}

std::string EnvironmentKind::accepted_degrees_of_freedom() const {
  if (degrees_of_freedom.empty()) return "1 to " + std::to_string(control::kDofMax);
  std::string text;
  for (const std::uint32_t accepted : degrees_of_freedom) {
    text += (text.empty() ? "" : " or ") + std::to_string(accepted);
  }
  return text;
}

}  // namespace forcebound::server
