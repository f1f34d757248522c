#include "forcebound/driver/driver_library.hpp"

#include <algorithm>
#include <cstring>

#include "forcebound/text/printable.hpp"

namespace forcebound::driver {
namespace {

constexpr PluginKind kKind{.name = "driver",
                           .prefix = "forcebound-device-",
                           .folder = "devices",
                           .entry = "forcebound_driver_entry",
                           .header = "forcebound_device.h"};

/// What only a device or only a robot needs.
void expect_functions_of(const forcebound_driver& functions, const SharedLibrary& library, DriverPurpose purpose) {
  const bool device = functions.describe != nullptr || functions.read != nullptr || functions.command != nullptr;
  const bool robot = functions.describe_robot != nullptr || functions.read_robot != nullptr;
  if (purpose == DriverPurpose::robot) {
    if (device && !robot) library.refuse("is for haptic devices, not for robots: it lacks 'describe_robot'");
    library.expect_function(functions.describe_robot != nullptr, "describe_robot");
    library.expect_function(functions.read_robot != nullptr, "read_robot");
    library.expect_function(functions.command_robot != nullptr, "command_robot");
    library.expect_function(functions.resume != nullptr, "resume");
    return;
  }
  if (robot && !device) {
    library.refuse("is for robots, not for haptic devices: forcebound-server --follower driver:FILE.so takes it");
  }
  library.expect_function(functions.describe != nullptr, "describe");
  library.expect_function(functions.read != nullptr, "read");
  library.expect_function(functions.command != nullptr, "command");
}

forcebound_driver functions_of(const SharedLibrary& library, const std::string& name, DriverPurpose purpose) {
  const auto& table = library.table<forcebound_driver>(FORCEBOUND_DEVICE_INTERFACE);
  forcebound_driver functions{};
  std::memcpy(&functions, &table, std::min<std::size_t>(table.size, sizeof functions));
  library.expect_function(functions.open != nullptr, "open");
  expect_functions_of(functions, library, purpose);
  library.expect_function(functions.start != nullptr, "start");
  library.expect_function(functions.stop != nullptr, "stop");
  library.expect_function(functions.close != nullptr, "close");
  const bool named_otherwise =
      purpose == DriverPurpose::device && (functions.name == nullptr || functions.name != name);
  if (named_otherwise) {
    library.refuse("calls itself '" + text::printable(functions.name == nullptr ? "" : functions.name) +
                   "', but its file is named for '" + name + "'");
  }
  if (functions.name == nullptr) functions.name = "nameless";
  if (functions.description == nullptr) functions.description = "";
  if (functions.settings == nullptr) functions.settings = "";
  return functions;
}

}  // namespace

std::vector<std::string> driver_folders(const char* device_path, const std::string& program) {
  return plugin_folders(kKind, device_path, program);
}

std::optional<std::string> find_driver(std::string_view name, const std::vector<std::string>& folders) {
  return find_plugin(kKind, name, folders);
}

std::vector<std::string> drivers_in(const std::vector<std::string>& folders) { return plugins_in(kKind, folders); }

DriverLibrary::DriverLibrary(const std::string& file, const std::string& name, DriverPurpose purpose)
    : library_(kKind, file), functions_(functions_of(library_, name, purpose)) {}

}  // namespace forcebound::driver
