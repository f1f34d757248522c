#include "forcebound/device/simulated/simulated_family.hpp"

#include <string_view>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/device/tick_rate.hpp"

namespace forcebound::device {
namespace {

constexpr std::string_view kHelp =
    "Devices (--device), simulated; or a TOML file with a device's facts:\n"
    "  wall-1dof       the paper's one-axis device, 30 N s/m, 15 um encoder\n"
    "  cartesian-2dof  two axes, 1 N s/m, 55 um\n"
    "  cartesian-3dof  three axes, 0.5 N s/m, 55 um\n"
    "  firm-3dof       three axes, 30 N s/m, 15 um\n"
    "  omni            three-joint arm in the size of a PHANToM Omni\n"
    "  arm-6dof        six-joint arm that shows torques too; all of it a guess\n"
    "  premium-6dof    likewise, in the size of a Phantom Premium 1.5/6DOF\n"
    "  falcon          delta in the size of a Novint Falcon; its damping is a guess\n"
    "  omega-3         delta as strong as an omega.3; sizes and damping are guesses\n"
    "  haply-2diy      five-bar in the size of a Haply 2DIY; its damping is a guess\n"
    "Operators (--operator), simulated hands; NAME:key=value,... changes numbers:\n"
    "  press           moves into a wall and stays\n"
    "  stroke          comes from above, goes to and fro\n"
    "  trace-circle    follows the inside of a circle\n"
    "  trace-sphere    follows the outside of a sphere\n"
    "  carry           picks something up with a button, puts it down elsewhere\n"
    "  wave            moves in free space\n"
    "  pointer         follows the pointer on the page of --page\n"
    "  replay:FILE.csv[,key=value,...]\n"
    "                  plays a recorded hand (time_s,x_m[,y_m,z_m])\n"
    "Each but carry presses a button of the handle with button=0,button_from_s=1 and,\n"
    "to let it go, button_until_s=5.\n"
    "On a six-joint arm each turns the handle with turn_x_rad=0.3 (y, z) and turn_Hz=0.5.\n"
    "The summary lists an operator's keys and their values; such as press:to_m=0.03, or "
    "replay:hand.csv,offset_x_m=0.01. Without --operator the device chooses one, without --device the operator "
    "does; without both it is press on wall-1dof. forcebound-server --scene SCENE --suggest prints a device and an "
    "operator that feel a scene.\n";

std::string hand_for(std::string_view device) {
  if (device == "wall-1dof") return "press";
  return device == "cartesian-2dof" || device == "haply-2diy" ? "trace-circle" : "trace-sphere";
}

std::string device_for(std::string_view hand) {
  const std::string_view name = hand.substr(0, hand.find(':'));
  if (name.empty() || name == "press") return "wall-1dof";
  return name == "trace-circle" ? "cartesian-2dof" : "omni";
}

void complete_simulated(DeviceRequest& request) {
  if (request.device.empty()) request.device = device_for(request.hand);
  if (request.hand.empty()) request.hand = hand_for(request.device);
}

std::unique_ptr<HapticDevice> make_simulated(const DeviceRequest& request) {
  DeviceDescription description = load_device(request.device);
  description.facts = at_tick_rate(std::move(description.facts), request.rate_Hz);
  auto hand = make_operator(request.hand, description.facts);
  return std::make_unique<SimulatedDevice>(std::move(description), std::move(hand));
}

}  // namespace

DeviceFamily simulated_devices() {
  return {.name = "simulated",
          .names = shipped_device_names(),
          .takes_files = true,
          .help = std::string(kHelp),
          .complete = complete_simulated,
          .facts = [](const std::string& name_or_file) { return load_device(name_or_file).facts; },
          .make = make_simulated};
}

}  // namespace forcebound::device
