#include "forcebound/client/app/known_devices.hpp"

#include <cstdlib>
#include <filesystem>

#include "forcebound/driver/driver_family.hpp"
#include "forcebound/driver/driver_library.hpp"

namespace forcebound::client {

device::DeviceRegistry known_devices() {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  device::DeviceRegistry devices = device::DeviceRegistry::standard();
  devices.add(driver::driver_family(driver::driver_folders(std::getenv("FORCEBOUND_DEVICE_PATH"), program.string())));
  return devices;
}

}  // namespace forcebound::client
