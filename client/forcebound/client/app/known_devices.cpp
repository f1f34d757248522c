#include "forcebound/client/app/known_devices.hpp"

#include <cstdlib>

#include "forcebound/driver/driver_family.hpp"
#include "forcebound/driver/driver_library.hpp"
#include "forcebound/text/file.hpp"

namespace forcebound::client {

device::DeviceRegistry known_devices() {
  device::DeviceRegistry devices = device::DeviceRegistry::standard();
  devices.add(
      driver::driver_family(driver::driver_folders(std::getenv("FORCEBOUND_DEVICE_PATH"), text::program_path())));
  return devices;
}

}  // namespace forcebound::client
