#pragma once

#include <memory>
#include <string>
#include <vector>

#include "forcebound/device/device_family.hpp"
#include "forcebound/device/haptic_device.hpp"

namespace forcebound::device {

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
