#include "forcebound/client/app/device_in_words.hpp"

namespace forcebound::client {

std::string first_words(const device::HapticDevice& device, const std::string& hand) {
  const std::string name = "device '" + device.facts().name + "'";
  if (device.is_simulated()) return name + " and its hand '" + hand + "' are simulated";
  if (device.bounds_are_identified()) return name + " is not simulated";
  return name + " is not simulated, its bounds not identified (forcebound-lab identify measures them)";
}

std::string guarantee_with(const device::HapticDevice& device, const std::string& guarantee) {
  if (guarantee.empty() || device.is_simulated() || device.bounds_are_identified()) return guarantee;
  return "nothing while this device's bounds are guesses (forcebound-lab identify measures them); after that " +
         guarantee;
}

}  // namespace forcebound::client
