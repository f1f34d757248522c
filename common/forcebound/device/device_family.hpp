#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/device/haptic_device.hpp"

namespace forcebound::device {

/// Device and simulated hand, as named on a command line.
struct DeviceRequest {
  std::string device{};  ///< name or file; empty: the default device for the hand
  std::string hand{};    ///< of a simulated device; empty: the default hand for the device
  double rate_Hz = 0;    ///< ticks per second, see at_tick_rate; 0: the device's own
};

/// Devices of one kind, selected by name. A driver registers one family.
struct DeviceFamily {
  std::string name;                  ///< of the kind
  std::vector<std::string> names{};  ///< of its devices
  bool takes_files = false;          ///< whether a file can describe another one
  std::string help{};                ///< devices and hands, a line each, for --help
  std::string hint{};                ///< for whoever names an unknown device: where this family looks; may be empty

  /// Whether a name that is not among `names`, such as one with settings, is a device of this family; no function:
  /// none.
  std::function<bool(const std::string& name)> knows{};

  /// Fills in the default device for a hand and the default hand for a device. Leaves the device empty if this family
  /// does not know the hand: another family may. No function: the family has no defaults.
  std::function<void(DeviceRequest&)> complete{};

  /// The facts of a device of this family. @throws std::runtime_error if the file is no valid device.
  std::function<control::DeviceFacts(const std::string& name_or_file)> facts;

  /// @throws std::exception with a one-line message.
  std::function<std::unique_ptr<HapticDevice>(const DeviceRequest&)> make;
};

}  // namespace forcebound::device
