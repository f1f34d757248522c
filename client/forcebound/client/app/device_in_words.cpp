#include "forcebound/client/app/device_in_words.hpp"

#include <spdlog/spdlog.h>

#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client {

std::string first_words(const device::HapticDevice& device, const std::string& hand) {
  const std::string name = "device '" + device.facts().name + "'";
  if (device.is_simulated()) return name + " and its hand '" + hand + "' are simulated";
  if (device.bounds_are_identified()) return name + " is not simulated";
  return name + " is not simulated, its bounds not identified (forcebound identify measures them)";
}

void warn_of_hand(const std::string& hand, const device::HapticDevice& device) {
  const std::string doubt = device::doubt_of_hand(hand, device.facts().translations());
  if (!doubt.empty()) spdlog::warn("{}", doubt);
}

std::string guarantee_with(const device::HapticDevice& device, const std::string& guarantee) {
  if (guarantee.empty() || device.is_simulated() || device.bounds_are_identified()) return guarantee;
  return "nothing while this device's bounds are guesses (forcebound identify measures them); after that " + guarantee;
}

std::string lost_words(const device::HapticDevice& device, std::string_view crash, bool device_stopped,
                       bool has_recording) {
  const std::string stuck =
      "has not returned from a call for 2 s; " +
      std::string(device_stopped ? "the device was stopped"
                                 : "its stop does not return either, so that a force may be left");
  return (crash.empty() ? "the driver of device '" + device.facts().name + "' " + stuck
                        : "device '" + device.facts().name + "': " + text::printable(crash)) +
         "; the client ends, without a summary" + (has_recording ? "; the recording has what was before" : "");
}

}  // namespace forcebound::client
