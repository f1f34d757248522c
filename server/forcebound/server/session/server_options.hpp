#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/session/memory_budget.hpp"
#include "forcebound/server/session/scene_sender.hpp"
#include "forcebound/server/session/shared_limits.hpp"
#include "forcebound/server/session/view_sender.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// A server's limits, default scene and server-side laws. The defaults are those of forcebound-server.
struct ServerOptions {
  std::string scene = "wall";            ///< for clients that request none; must be in the library
  std::vector<std::string> scenes{};     ///< that clients may request, besides `scene`; empty: all of the library
  std::size_t sessions_max = 64;         ///< at once
  std::size_t sessions_per_address = 0;  ///< at once, of an IP address whatever the port; 0: no such limit
  Nanoseconds idle_timeout =
      std::chrono::seconds{60};  ///< without motion; must exceed any round trip (12 s has been observed)
  /// Without motion for so long, a client loses its place in a shared scene to one who asks for it while it is full.
  Nanoseconds presence_timeout = std::chrono::seconds{20};
  /// Its device not moved by more than 1 mm for so long, it does too, although its motions arrive.
  Nanoseconds stillness_timeout = std::chrono::seconds{60};
  double motions_per_promised = 4;  ///< answers per motion that the client promised in its Hello
  double session_compute_max =
      0.5;                    ///< share of the server's thread that answers of one session may take beside others
  double load_max = 0.9;      ///< share of the server's thread above which nobody more is let in
  int hellos_per_s_max = 50;  ///< from each source: an IPv4 address or IPv6 network
  MemoryLimits memory{};
  HandoverRate handover{};                                ///< of scenes, to each client that renders locally
  ViewRate view{};                                        ///< of pictures, to clients that ask
  WorkerPlace worker{};                                   ///< among the servers of this process
  control::LawRegistry laws = baselines::shipped_laws();  ///< the laws whose server-side law clients can request
};

}  // namespace forcebound::server
