#pragma once

#include <functional>

#include "forcebound/client/commands/check_device/device_check.hpp"
#include "forcebound/client/commands/check_device/device_driving.hpp"

namespace forcebound::client::commands {

/// Checks for which a person unplugs the device, plugs it in again and presses its buttons: readings fail while it is
/// unplugged; it has no force once it is plugged in until one is commanded, and has one then; buttons arrive. A person
/// who does nothing for a minute fails the check.
///
/// While it is unplugged `force_N` is commanded along x, of which a driver must keep nothing. Nobody may hold the
/// device once it is plugged in.
///
/// @param found is called with each check
void check_with_a_person(DeviceDriving& driving, Person& person, double force_N,
                         const std::function<void(const DeviceCheck&)>& found);

}  // namespace forcebound::client::commands
