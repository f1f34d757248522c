#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>

#include "library/source/errors.hpp"
#include "library/source/server.hpp"
#include "library/source/structs.hpp"

namespace forcebound::library {
namespace {

using Probe = server::Simulator::Probe;

constexpr std::size_t kTouchLeast = offsetof(fb_touch, others_N);
static_assert(server::kTouchesMost == FB_TOUCHES_MAX);

void set(double (&to)[3], const server::Point& from) noexcept { std::copy_n(from.data(), 3, to); }

fb_probe probe_of(const Probe& probe) noexcept {
  fb_probe told{};
  told.client = probe.client;
  told.interval_s = probe.interval_s;
  set(told.place_m, probe.place_m);
  set(told.velocity_m_per_s, probe.velocity_m_per_s);
  set(told.device_m, probe.device_m);
  told.buttons = probe.buttons;
  told.push_count = static_cast<std::uint32_t>(probe.push_count);
  return told;
}

server::Touch touch_of(const fb_touch& given) {
  using Square = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  server::Touch touch{.body = given.body,
                      .place_m = Eigen::Map<const server::Point>(given.place_m),
                      .normal = Eigen::Map<const server::Point>(given.normal),
                      .velocity_m_per_s = Eigen::Map<const server::Point>(given.velocity_m_per_s),
                      .mobility_per_kg = Eigen::Map<const Square>(given.mobility_per_kg),
                      .others_N = Eigen::Map<const server::Point>(given.others_N),
                      .spring_N_per_m = given.spring_N_per_m,
                      .damper_N_s_per_m = given.damper_N_s_per_m,
                      .dry_friction_N = given.dry_friction_N,
                      .friction = given.friction};
  if (given.radius_m != 0) touch.radius_m = given.radius_m;
  return touch;
}

/// A server of a simulator; else why not.
fb_status expect_simulator(const char* function, const fb_server* server) noexcept {
  if (server == nullptr) return refused(function, "server is null");
  if (server->served.simulator != nullptr) return FB_OK;
  return refused(function, "the server has callbacks: accepted is one of fb_server_of_simulator");
}

/// What a program met.
/// @param met room for as many as there can be
fb_status read(const char* function, const fb_touch* touches, std::size_t count, server::Touches& met) {
  if (count > 0 && touches == nullptr) return refused(function, "touches is null, and count is not 0");
  if (count > FB_TOUCHES_MAX) {
    return refused(function, "count is " + std::to_string(count) + ", accepted are up to " +
                                 std::to_string(FB_TOUCHES_MAX) + " touches of a probe");
  }
  std::size_t taken = 0;
  return take_each(function, "fb_touch", touches, count, kTouchLeast,
                   [&](const fb_touch& touch) { met.at(taken++) = touch_of(touch); });
}

fb_status report(fb_server& server, const char* function, std::uint64_t client, const fb_touch* touches,
                 std::size_t count) {
  server::Simulator& simulator = *server.served.simulator;
  server::Touches met{};
  if (const fb_status status = read(function, touches, count, met); status != FB_OK) {
    simulator.count_refused();
    return status;
  }
  if (simulator.report(client, std::span(met).first(count))) return FB_OK;
  return refused(function,
                 "client " + std::to_string(client) + " is not there: accepted are those that were asked for last",
                 FB_NOT_NOW);
}

}  // namespace
}  // namespace forcebound::library

using namespace forcebound;  // NOLINT(google-build-using-namespace)

fb_status fb_server_ask(fb_server* server, size_t* probes) {
  constexpr const char* kFunction = "fb_server_ask";
  if (const fb_status status = library::expect_simulator(kFunction, server); status != FB_OK) return status;
  if (probes == nullptr) return library::refused(kFunction, "probes is null");
  *probes = server->probe_count = server->served.simulator->probes(server->probes);
  return FB_OK;
}

fb_status fb_server_probe(fb_server* server, size_t index, fb_probe* probe) {
  constexpr const char* kFunction = "fb_server_probe";
  if (const fb_status status = library::expect_simulator(kFunction, server); status != FB_OK) return status;
  if (index >= server->probe_count) return FB_NOTHING;
  return library::give(kFunction, "fb_probe", library::probe_of(server->probes.at(index)), probe,
                       offsetof(fb_probe, buttons));
}

fb_status fb_server_push(fb_server* server, size_t probe, size_t index, fb_push* push) {
  constexpr const char* kFunction = "fb_server_push";
  if (const fb_status status = library::expect_simulator(kFunction, server); status != FB_OK) return status;
  if (probe >= server->probe_count || index >= server->probes.at(probe).push_count) return FB_NOTHING;
  const server::Simulator::Push& from = server->probes.at(probe).pushes.at(index);
  fb_push told{};
  told.body = from.body;
  library::set(told.place_m, from.place_m);
  library::set(told.impulse_Ns, from.impulse_Ns);
  return library::give(kFunction, "fb_push", told, push, sizeof(fb_push));
}

fb_status fb_server_report(fb_server* server, uint64_t client, const fb_touch* touches, size_t count) {
  constexpr const char* kFunction = "fb_server_report";
  if (const fb_status status = library::expect_simulator(kFunction, server); status != FB_OK) return status;
  return library::guarded(kFunction, [&] { return library::report(*server, kFunction, client, touches, count); });
}
