#include "forcebound/server/app/serve.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <iostream>
#include <memory>
#include <random>

#include "forcebound/net/udp_link.hpp"
#include "forcebound/server/app/log_observer.hpp"
#include "forcebound/server/app/recording_observer.hpp"
#include "forcebound/server/app/scene_compiler.hpp"
#include "forcebound/server/scene/explain.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Also how late the end may be noticed: a signal between two waits wakes nobody.
constexpr Nanoseconds kTimerPeriod = milliseconds{100};
constexpr Nanoseconds kReportPeriod = seconds{10};
// Below a client's on the same machine, whose deadline is the hard one.
constexpr int kPriority = 40;
// A flood must not keep the loop from its timer and its end.
constexpr int kDatagramsPerTurn = 256;

volatile std::sig_atomic_t stop_wanted = 0;

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_wanted = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A full disk or a closed pipe is an error of writing, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

/// The system's randomness, so that nobody guesses a session.
std::uint64_t random_session_id() {
  static std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

void drain(net::UdpLink& link, Server& server, const time::Clock& clock) {
  std::array<std::byte, net::kDatagramBytesMax> buffer;
  for (int i = 0; i < kDatagramsPerTurn; ++i) {
    const auto received = link.receive(buffer);
    if (!received) break;
    const std::size_t bytes = std::min(received->bytes, buffer.size());
    server.take_in(std::span{buffer}.first(bytes), received->from, clock.now());
  }
  server.answer_waiting();
}

void report(const Server& server) {
  const ServerCounters counters = server.counters();
  spdlog::info("{} sessions, {} motions received, {} forces sent, {} datagrams in all", server.sessions(),
               counters.motions_received, counters.forces_sent, counters.datagrams);
}

void run(net::UdpLink& link, Server& server, SceneCompiler& compiler, const time::Clock& clock, bool verbose) {
  Nanoseconds timer = clock.now() + kTimerPeriod;
  Nanoseconds next_report = clock.now() + kReportPeriod;
  const std::array descriptors{link.descriptor()};
  while (stop_wanted == 0) {
    const bool readable = net::wait_readable(descriptors, timer - clock.now());
    compiler.deliver();
    if (readable) drain(link, server, clock);
    const Nanoseconds now = clock.now();
    if (now < timer) continue;
    server.on_timer(now);
    timer = now + kTimerPeriod;
    if (!verbose || now < next_report) continue;
    report(server);
    next_report = now + kReportPeriod;
  }
}

std::unique_ptr<ServerObserver> make_observer(const ProgramOptions& options, const Scene& scene,
                                              const time::Clock& clock) {
  if (options.record.empty()) return std::make_unique<LogObserver>(clock);
  record::RunInfo info;
  info.program = "forcebound-server " FORCEBOUND_VERSION;
  info.scene = scene.facts().name;
  info.simulated = summary(scene);
  info.epoch = time::wall_clock_now() - clock.now();
  return std::make_unique<RecordingObserver>(clock, options.record, info);
}

}  // namespace

void serve(ProgramOptions options) {
  const time::SteadyClock clock;
  const auto scene = load_scene(options.scene);
  SceneLibrary scenes = SceneLibrary::shipped();
  scenes.add(scene);
  SceneCompiler compiler(scenes);
  options.server.scene = scene->facts().name;

  stop_on_signals();
  auto link = net::UdpLink::listen(net::resolve(options.listen));
  const auto observer = make_observer(options, *scene, clock);
  Server server(options.server, std::move(scenes), link, clock, random_session_id, observer.get());
  if (options.realtime) spdlog::info("{}", time::ask_for_real_time(kPriority).text);
  spdlog::info("listening on {}, scene '{}': {}", net::to_string(link.local_address()), scene->facts().name,
               summary(*scene));

  run(link, server, compiler, clock, options.verbose);
  server.stop();
  std::cout << server.counters().text();
  if (const auto lost = link.counters().overflowed; lost > 0) {
    std::cout << "socket: " << lost << " datagrams lost because it was full\n";
  }
  std::cout << std::flush;
}

}  // namespace forcebound::server
