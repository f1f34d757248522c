#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/device/haptic_device.hpp"

namespace forcebound::device {

/// Which device, as a person names it.
struct DeviceRequest {
  std::string device{};  ///< a name or a file; empty: whichever goes with the hand
  std::string hand{};    ///< what moves a simulated device; empty: whichever goes with the device
};

/// Devices of one kind, which one can ask for by name: what a driver registers.
struct DeviceFamily {
  std::string name;                  ///< of the kind
  std::vector<std::string> names{};  ///< of its devices
  bool takes_files = false;          ///< whether a file can describe another one
  std::string help{};                ///< devices and hands, a line each, for --help

  /// Fills in the device that goes with a hand and the hand that goes with a device; empty: there is nothing to fill
  /// in. Asked without a device it may leave it so: then another family knows the hand.
  std::function<void(DeviceRequest&)> complete{};

  /// The facts of a device of this family. @throws std::runtime_error about a file that describes none.
  std::function<control::DeviceFacts(const std::string& name_or_file)> facts;

  /// @throws std::exception with one line for a person.
  std::function<std::unique_ptr<HapticDevice>(const DeviceRequest&)> make;
};

/// The devices one can ask for by name. A value: a program takes `standard()`, adds its own and hands it on.
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

  /// The request with nothing left empty that a family can fill in.
  [[nodiscard]] DeviceRequest completed(DeviceRequest request) const;

  /// @throws std::runtime_error naming the known devices, or about the file.
  [[nodiscard]] control::DeviceFacts facts(const std::string& name_or_file) const;

  /// @param request completed.
  /// @throws std::exception as `facts`, or with what the device refuses.
  [[nodiscard]] std::unique_ptr<HapticDevice> make(const DeviceRequest& request) const;

  [[nodiscard]] std::vector<std::string> names() const;

  /// What `--help` says of them.
  [[nodiscard]] std::string help() const;

 private:
  [[nodiscard]] const DeviceFamily* find(const std::string& name_or_file) const;
  [[nodiscard]] const DeviceFamily& known(const std::string& name_or_file) const;

  std::vector<DeviceFamily> families_;
};

}  // namespace forcebound::device
