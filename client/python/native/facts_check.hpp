#pragma once

#include "forcebound/control/device_facts.hpp"

namespace forcebound::python {

/// Facts made in Python are held to what a device's file may say (load_device.hpp).
/// @throws std::invalid_argument naming the field, what is accepted and what it is
void expect_possible(const control::DeviceFacts& facts);

/// Facts of the same mechanism as `other`: joints, axes, and whether these are the same.
/// @throws std::invalid_argument
void expect_same_mechanism(const control::DeviceFacts& facts, const control::DeviceFacts& other);

}  // namespace forcebound::python
