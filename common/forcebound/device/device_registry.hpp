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

/// The devices that can be selected by name. A value type: a program takes `standard()`, adds its own families and
/// passes the registry on.
///
///     auto devices = DeviceRegistry::standard();
///     devices.add({.name = "pens", .names = {"pen"}, .help = "  pen  a pen on USB\n", .facts = ..., .make = ...});
class DeviceRegistry {
 public:
  /// The simulated devices.
  [[nodiscard]] static DeviceRegistry standard();

  /// @throws std::invalid_argument without a name, a function for facts or one to make a device, for a device's name
  /// that is taken, or for a second family that takes files.
  void add(DeviceFamily family);

  /// The request with every empty field filled in for which a family has a default.
  [[nodiscard]] DeviceRequest completed(DeviceRequest request) const;

  /// @throws std::invalid_argument naming the known devices; std::runtime_error about the file.
  [[nodiscard]] control::DeviceFacts facts(const std::string& name_or_file) const;

  /// @param request completed.
  /// @throws std::exception as `facts`, or if the device refuses the request.
  [[nodiscard]] std::unique_ptr<HapticDevice> make(const DeviceRequest& request) const;

  [[nodiscard]] std::vector<std::string> names() const;

  /// The families' texts for `--help`.
  [[nodiscard]] std::string help() const;

 private:
  [[nodiscard]] const DeviceFamily* find(const std::string& name_or_file) const;
  [[nodiscard]] const DeviceFamily& known(const std::string& name_or_file) const;

  std::vector<DeviceFamily> families_;
};

}  // namespace forcebound::device
