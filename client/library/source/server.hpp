#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "forcebound/net/udp_link.hpp"
#include "forcebound/server/runtime/udp_server.hpp"
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
  fb_server(forcebound::net::UdpLink link, const forcebound::server::ServerOptions& options,
            forcebound::library::Served served, std::optional<forcebound::server::ServerKeys> keys);

  const forcebound::library::Served served;
  const std::string encryption;
  forcebound::server::UdpServer server;
  std::mutex mutex;  ///< of what follows, but `running`
  bool started = false;
  std::string failure{};  ///< of the thread; empty: none
  std::atomic<bool> running{false};
  std::atomic<std::thread::id> runs_on{};
  // Of a simulator's thread, but for the counts.
  std::array<forcebound::server::Simulator::Probe, forcebound::library::kProbesMost> probes{};
  std::size_t probe_count = 0;
  std::atomic<std::uint64_t> reports{0};
  std::atomic<std::uint64_t> reports_refused{0};
  std::mutex ending;    ///< of who waits for the thread
  std::jthread thread;  ///< last: ends before what it uses
};
