#include "forcebound/driver/driver_library.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "forcebound/driver/crash.hpp"
#include "forcebound/driver/written_by_owner.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::driver {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "forcebound-device-";
constexpr std::string_view kSuffix = ".so";
constexpr const char* kEntry = "forcebound_driver_entry";

[[noreturn]] void refuse_driver(const std::string& file, const std::string& why) {
  throw std::runtime_error("driver " + text::printable(file) + ": " + why);
}

void* opened(const std::string& file) {
  try {
    expect_written_by_owner(file);
  } catch (const std::runtime_error& error) {
    refuse_driver(file, error.what());
  }
  const CallInProgress in_progress(file.c_str(), "its library's initialisers");
  // Now, not while the tick runs; and with names of its own, lest two vendors' libraries meet.
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library != nullptr) return library;
  const char* const why = ::dlerror();
  refuse_driver(file, "cannot be loaded: " + text::printable(why == nullptr ? "unknown error" : why));
}

void expect_function(const std::string& file, bool there, const char* function) {
  if (!there) refuse_driver(file, std::string("lacks the function '") + function + "'; forcebound_device.h names all");
}

/// What only a device or only a robot needs.
void expect_functions_of(const forcebound_driver& functions, const std::string& file, DriverPurpose purpose) {
  const bool device = functions.describe != nullptr || functions.read != nullptr || functions.command != nullptr;
  const bool robot = functions.describe_robot != nullptr || functions.read_robot != nullptr;
  if (purpose == DriverPurpose::robot) {
    if (device && !robot) refuse_driver(file, "is for haptic devices, not for robots: it lacks 'describe_robot'");
    expect_function(file, functions.describe_robot != nullptr, "describe_robot");
    expect_function(file, functions.read_robot != nullptr, "read_robot");
    expect_function(file, functions.command_robot != nullptr, "command_robot");
    expect_function(file, functions.resume != nullptr, "resume");
    return;
  }
  if (robot && !device) {
    refuse_driver(file, "is for robots, not for haptic devices: forcebound-server --follower driver:FILE.so takes it");
  }
  expect_function(file, functions.describe != nullptr, "describe");
  expect_function(file, functions.read != nullptr, "read");
  expect_function(file, functions.command != nullptr, "command");
}

forcebound_driver functions_of(void* library, const std::string& file, const std::string& name, DriverPurpose purpose) {
  using Entry = const forcebound_driver* (*)(std::uint32_t);
  const auto entry = reinterpret_cast<Entry>(::dlsym(library, kEntry));
  if (entry == nullptr) {
    refuse_driver(file, std::string("is no driver: it lacks the function '") + kEntry + "' of forcebound_device.h");
  }
  const CallInProgress in_progress(file.c_str(), kEntry);
  const forcebound_driver* const table = entry(FORCEBOUND_DEVICE_INTERFACE);
  if (table == nullptr) refuse_driver(file, "has no table of functions");
  if (table->interface_version != FORCEBOUND_DEVICE_INTERFACE) {
    refuse_driver(file, "has interface " + std::to_string(table->interface_version) + ", this program has " +
                            std::to_string(FORCEBOUND_DEVICE_INTERFACE) +
                            ": build it with this program's forcebound_device.h");
  }
  forcebound_driver functions{};
  std::memcpy(&functions, table, std::min<std::size_t>(table->size, sizeof functions));
  expect_function(file, functions.open != nullptr, "open");
  expect_functions_of(functions, file, purpose);
  expect_function(file, functions.start != nullptr, "start");
  expect_function(file, functions.stop != nullptr, "stop");
  expect_function(file, functions.close != nullptr, "close");
  const bool named_otherwise =
      purpose == DriverPurpose::device && (functions.name == nullptr || functions.name != name);
  if (named_otherwise) {
    refuse_driver(file, "calls itself '" + text::printable(functions.name == nullptr ? "" : functions.name) +
                            "', but its file is named for '" + name + "'");
  }
  if (functions.name == nullptr) functions.name = "nameless";
  if (functions.description == nullptr) functions.description = "";
  if (functions.settings == nullptr) functions.settings = "";
  return functions;
}

/// The driver's name in a file's name; empty: it is no driver's.
std::string driver_named_by(const fs::path& file) {
  const std::string name = file.filename().string();
  if (name.size() <= kPrefix.size() + kSuffix.size() || !name.starts_with(kPrefix) || !name.ends_with(kSuffix))
    return {};
  return name.substr(kPrefix.size(), name.size() - kPrefix.size() - kSuffix.size());
}

}  // namespace

std::vector<std::string> driver_folders(const char* device_path, const std::string& program) {
  std::vector<std::string> folders;
  std::string_view rest = device_path == nullptr ? std::string_view{} : std::string_view{device_path};
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  const fs::path beside = fs::path(program).parent_path();
  folders.push_back((beside.parent_path() / "lib" / "forcebound" / "devices").string());
  return folders;
}

std::optional<std::string> find_driver(std::string_view name, const std::vector<std::string>& folders) {
  // A name is never a path.
  if (name.empty() || name.find('/') != std::string_view::npos) return std::nullopt;
  const std::string file = std::string(kPrefix) + std::string(name) + std::string(kSuffix);
  for (const std::string& folder : folders) {
    const fs::path path = fs::path(folder) / file;
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) return path.string();
  }
  return std::nullopt;
}

std::vector<std::string> drivers_in(const std::vector<std::string>& folders) {
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    for (fs::directory_iterator file(folder, ignored); file != fs::directory_iterator(); file.increment(ignored)) {
      if (std::string name = driver_named_by(file->path()); !name.empty()) names.push_back(std::move(name));
    }
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

DriverLibrary::DriverLibrary(const std::string& file, const std::string& name, DriverPurpose purpose)
    : file_(file), library_(opened(file)) {
  try {
    functions_ = functions_of(library_, file, name, purpose);
  } catch (...) {
    ::dlclose(library_);
    throw;
  }
}

DriverLibrary::~DriverLibrary() { ::dlclose(library_); }

}  // namespace forcebound::driver
