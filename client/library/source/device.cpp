#include "library/source/device.hpp"

#include <dlfcn.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/device/device_registry.hpp"
#include "forcebound/driver/driver_family.hpp"
#include "forcebound/driver/driver_library.hpp"
#include "forcebound/text/file.hpp"
#include "library/source/errors.hpp"
#include "library/source/facts.hpp"
#include "library/source/structs.hpp"

namespace {

using forcebound::library::OpenedDevice;

/// Where drivers are installed beside this library: in its folder, or the one above where that is an architecture's.
std::vector<std::string> folders_of_drivers() {
  std::vector<std::string> folders =
      forcebound::driver::driver_folders(std::getenv("FORCEBOUND_DEVICE_PATH"), forcebound::text::program_path());
  Dl_info here{};
  if (::dladdr(reinterpret_cast<const void*>(&fb_version), &here) == 0) return folders;
  const std::filesystem::path library = std::filesystem::path(here.dli_fname).parent_path();
  for (const std::filesystem::path& folder : {library, library.parent_path()}) {
    folders.push_back((folder / "forcebound" / "devices").string());
  }
  return folders;
}

fb_status open(const std::string& device, const std::string& hand, fb_device** opened) {
  auto devices = forcebound::device::DeviceRegistry::standard();
  devices.add(forcebound::driver::driver_family(folders_of_drivers()));
  const auto request = devices.completed({.device = device, .hand = hand});
  auto made = std::make_shared<OpenedDevice>();
  made->device = devices.make(request);
  made->hand = request.hand;
  *opened = std::make_unique<fb_device>(fb_device{std::move(made)}).release();
  return FB_OK;
}

fb_status of_callbacks(const fb_facts& facts, const fb_device_callbacks& callbacks, fb_device** device) {
  auto own = std::make_unique<forcebound::library::CallbackDevice>(facts.device, callbacks);
  auto made = std::make_shared<OpenedDevice>();
  made->callbacks = own.get();
  made->device = std::move(own);
  *device = std::make_unique<fb_device>(fb_device{std::move(made)}).release();
  return FB_OK;
}

}  // namespace

fb_status fb_device_open(const char* device, const char* hand, fb_device** opened) {
  if (device == nullptr || opened == nullptr) {
    return forcebound::library::refused("fb_device_open", "device or opened is null");
  }
  return forcebound::library::guarded("fb_device_open",
                                      [&] { return open(device, hand == nullptr ? "" : hand, opened); });
}

fb_status fb_device_of_callbacks(const fb_facts* facts, const fb_device_callbacks* callbacks, fb_device** device) {
  constexpr const char* kFunction = "fb_device_of_callbacks";
  if (facts == nullptr || device == nullptr) return forcebound::library::refused(kFunction, "facts or device is null");
  const forcebound::library::Given<fb_device_callbacks> given(kFunction, "fb_device_callbacks", callbacks,
                                                              offsetof(fb_device_callbacks, stop));
  if (given.status() != FB_OK) return given.status();
  if (given->read == nullptr || given->command == nullptr) {
    return forcebound::library::refused(kFunction, "fb_device_callbacks: read and command must be functions, got null");
  }
  return forcebound::library::guarded(kFunction, [&] { return of_callbacks(*facts, *given, device); });
}

void fb_device_destroy(fb_device* device) { delete device; }
