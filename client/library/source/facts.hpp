#pragma once

#include <string>

#include "forcebound/device/load_device.hpp"
#include "library/forcebound.h"

/// What fb_facts points at.
struct fb_facts {
  forcebound::device::RealDevice device;
};
