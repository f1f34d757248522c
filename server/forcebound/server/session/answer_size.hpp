#pragma once

#include <cstddef>

#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// Bytes of the UDP datagram, headers of IP and UDP included, that answers a motion in contact with the object of the
/// scene that says most.
std::size_t answer_bytes(const scene::Scene& scene);

}  // namespace forcebound::server
