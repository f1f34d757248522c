#pragma once

#include <cstddef>

#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// Bytes of the largest answer to a motion in contact, as a UDP datagram with its IP and UDP headers: over all objects
/// of the scene.
std::size_t answer_bytes(const scene::Scene& scene);

}  // namespace forcebound::server
