#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "forcebound/server/runtime/embedded_server.hpp"
#include "forcebound/server/simulator/simulator.hpp"
#include "library/forcebound.h"
#include "library/source/callback_environment.hpp"

namespace forcebound::library {

/// Of a simulator, at once.
inline constexpr std::size_t kProbesMost = 64;

/// What a server serves: an environment of callbacks, or a simulator.
struct Served {
  server::EnvironmentKind kind{};
  std::string simulated{};
  std::shared_ptr<EnvironmentCallbacks> callbacks{};  ///< null: a simulator
  std::shared_ptr<server::Simulator> simulator{};     ///< null: callbacks
};

}  // namespace forcebound::library

/// What fb_server points at.
struct fb_server {
  const forcebound::library::Served served;
  forcebound::server::EmbeddedServer server;
  // Of a simulator's thread.
  std::array<forcebound::server::Simulator::Probe, forcebound::library::kProbesMost> probes{};
  std::size_t probe_count = 0;
};
