#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "forcebound/device/haptic_device.hpp"
#include "library/forcebound.h"
#include "library/source/callback_device.hpp"

namespace forcebound::library {

/// A device that handle and client share, so that neither has to be destroyed before the other.
struct OpenedDevice {
  std::unique_ptr<device::HapticDevice> device;
  const CallbackDevice* callbacks = nullptr;  ///< null: it is one of ours
  std::string hand{};                         ///< that moves it, as in device::DeviceRequest
  std::atomic<bool> in_use{false};            ///< by a client
};

}  // namespace forcebound::library

/// What fb_device points at.
struct fb_device {
  std::shared_ptr<forcebound::library::OpenedDevice> opened;
};
