#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace forcebound::lab {

/// Clients that arrive at a fleet, stay, change their address and leave, and nodes that fail; all times in seconds.
///
/// What is assumed: sessions begin at random, independent of each other (Poisson), and last exponentially. A server is
/// one core. Each client sends 1000 motions a second, evenly; one costs `motion_s` of its server's core. A client that
/// begins, comes back or changes its address costs `handshake_s` of what motions leave of the core, behind those who
/// ask that server at the same time. The allocator answers one client after the other. A node that fails takes its
/// servers with it at once; their clients notice after `notice_s` and up to `spread_s` more, and ask for another
/// server, as who finds none does again after `retry_s`. A client gets a place on the fullest server that has one, else
/// on one that waits. The fleet looks every `look_s` whether fewer than `spares` servers wait for clients or are being
/// started, starts what is missing, each serving after `start_s`, and ends what is too much.
struct FleetSettings {
  std::size_t clients = 100'000;
  double arrive_s = 1800;   ///< within which they all arrive
  double stay_s = 1800;     ///< mean
  double roam_s = 600;      ///< mean from one change of address of a client to the next; 0: never
  std::size_t places = 64;  ///< of a server
  std::size_t servers_of_node = 16;
  std::size_t servers_most = 4000;
  std::size_t spares = 40;
  double look_s = 5;
  double start_s = 10;
  double notice_s = 0.5;
  double spread_s = 0.05;
  double retry_s = 1;
  double allocate_s = 0.002;
  double motion_s = 1.0 / 140'000;
  double handshake_s = 0.28e-3;
  std::vector<double> failures_s{1500};  ///< when a node fails: the one with most sessions
  std::uint64_t seed = 1;
};

/// A moment of a run, for a figure.
struct FleetMoment {
  double time_s = 0;
  std::size_t sessions = 0;
  std::size_t waiting = 0;  ///< clients without a server
  std::size_t in_use = 0;   ///< servers
  std::size_t ready = 0;
  std::size_t starting = 0;
};

/// What came of a run. Waits are from asking for a server to having a session.
struct FleetResult {
  std::size_t arrived = 0;
  std::size_t left = 0;            ///< after their stay
  std::size_t roamed = 0;          ///< changes of address
  std::size_t failed_over = 0;     ///< sessions whose node failed
  std::size_t back = 0;            ///< of them, those that had a session again
  std::size_t left_meanwhile = 0;  ///< of them, those whose stay was over before
  std::size_t refused = 0;         ///< answers of the allocator that there is no server
  std::size_t sessions_most = 0;
  std::size_t servers_most = 0;  ///< that served or waited for clients
  std::size_t sessions_of_server_most = 0;
  double sessions_mean = 0;            ///< over the second half of the arrivals
  std::vector<double> waits_s{};       ///< of arrivals, in ascending order
  std::vector<double> outages_s{};     ///< from the failure to the new session, in ascending order
  std::vector<double> handshakes_s{};  ///< from asking a server until it had answered, in ascending order
  std::vector<FleetMoment> moments{};  ///< each second
};

/// @throws std::invalid_argument naming a setting that makes no fleet
[[nodiscard]] FleetResult simulate_fleet(const FleetSettings& settings);

/// Mean wait of a motion for those before it, where motions come at random to a core that is busy for the share `load`
/// of the time and each takes `service_s`: load service / (2 (1 - load)) [Pollaczek and Khinchine, M/D/1]. Motions of
/// clients that are evenly spread wait less.
/// @throws std::invalid_argument unless 0 <= load < 1
[[nodiscard]] double mean_wait_s(double load, double service_s);

/// The nearest rank; NaN without values. @param ascending sorted
[[nodiscard]] double at_share(const std::vector<double>& ascending, double share);

/// The moments as CSV.
[[nodiscard]] std::string fleet_csv(const FleetResult& result);

}  // namespace forcebound::lab
