#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "forcebound/net/udp_link.hpp"
#include "forcebound/server/runtime/udp_server.hpp"
#include "library/forcebound.h"
#include "library/source/callback_environment.hpp"

/// What fb_server points at.
struct fb_server {
  fb_server(forcebound::net::UdpLink link, const forcebound::server::ServerOptions& options,
            std::shared_ptr<forcebound::library::EnvironmentCallbacks> serves,
            std::optional<forcebound::server::ServerKeys> keys);

  const std::shared_ptr<forcebound::library::EnvironmentCallbacks> callbacks;
  const std::string encryption;
  forcebound::server::UdpServer server;
  std::mutex mutex;  ///< of what follows, but `running`
  bool started = false;
  std::string failure{};  ///< of the thread; empty: none
  std::atomic<bool> running{false};
  std::atomic<std::thread::id> runs_on{};
  std::mutex ending;    ///< of who waits for the thread
  std::jthread thread;  ///< last: ends before what it uses
};
