#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/driver/forcebound_device.h"
#include "forcebound/driver/shared_library.hpp"

namespace forcebound::driver {

/// The folders in which drivers are looked for, in this order.
/// @param device_path what FORCEBOUND_DEVICE_PATH holds, colons between folders; may be null
/// @param program the running program's file: beside it, in ../lib/forcebound/devices, are the installed drivers
[[nodiscard]] std::vector<std::string> driver_folders(const char* device_path, const std::string& program);

/// The file of a driver, forcebound-device-NAME.so, in the first folder that has it.
[[nodiscard]] std::optional<std::string> find_driver(std::string_view name, const std::vector<std::string>& folders);

/// The names of all drivers there, sorted, each once.
[[nodiscard]] std::vector<std::string> drivers_in(const std::vector<std::string>& folders);

/// What a driver is loaded for, which says what functions it must have.
enum class DriverPurpose { device, robot };

/// The shared library of a driver, which stays open as long as this lives.
class DriverLibrary {
 public:
  /// @param file its path
  /// @param name as it must call itself; one of a robot, which is found by its path, may have any
  /// @throws std::runtime_error in one line: what the file is not, which interface it has, or who else may write it
  DriverLibrary(const std::string& file, const std::string& name, DriverPurpose purpose = DriverPurpose::device);

  /// Its functions. What a driver of an older interface lacks is null.
  [[nodiscard]] const forcebound_driver& functions() const noexcept { return functions_; }
  [[nodiscard]] const std::string& file() const noexcept { return library_.file(); }

 private:
  SharedLibrary library_;
  forcebound_driver functions_{};
};

}  // namespace forcebound::driver
