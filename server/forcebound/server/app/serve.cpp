#include "forcebound/server/app/serve.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <iostream>
#include <memory>
#include <random>

#include "forcebound/net/udp_batch.hpp"
#include "forcebound/net/udp_link.hpp"
#include "forcebound/server/app/log_observer.hpp"
#include "forcebound/server/app/recording_observer.hpp"
#include "forcebound/server/app/scene_compiler.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/text/terminal.hpp"
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
constexpr int kBatchesPerTurn = 64;
// As long as answers may wait for others to go with them.
constexpr Nanoseconds kAnswersTogether = std::chrono::microseconds{100};

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

/// Takes in all that waits, a batch at a time, and then answers the newest motion of each client.
void drain(net::UdpBatch& batch, Server& server, const time::Clock& clock) {
  for (int i = 0; i < kBatchesPerTurn; ++i) {
    const auto arrived = batch.receive_all();
    const Nanoseconds now = clock.now();
    for (const auto& datagram : arrived) server.take_in(datagram.bytes, datagram.received.from, now);
    // Asking whether there are more costs a call; the next wait asks the same.
    if (arrived.size() < net::UdpBatch::kDatagramsMax) break;
  }
  // Who was answered shall not wait for a scene of somebody else's that takes long.
  Nanoseconds flushed = clock.now();
  while (server.answer_next()) {
    if (clock.now() - flushed < kAnswersTogether) continue;
    batch.flush();
    flushed = clock.now();
  }
  batch.flush();
}

void report(const Server& server) {
  const ServerCounters counters = server.counters();
  spdlog::info("{} sessions, {} motions received, {} forces sent, {} datagrams in all", server.sessions(),
               counters.motions_received, counters.forces_sent, counters.datagrams);
}

void run(const net::UdpLink& link, net::UdpBatch& batch, Server& server, SceneCompiler& compiler,
         const time::Clock& clock, bool verbose) {
  Nanoseconds timer = clock.now() + kTimerPeriod;
  Nanoseconds next_report = clock.now() + kReportPeriod;
  const std::array descriptors{link.descriptor()};
  while (stop_wanted == 0) {
    const bool readable = net::wait_readable(descriptors, timer - clock.now());
    compiler.deliver();
    if (readable) drain(batch, server, clock);
    const Nanoseconds now = clock.now();
    if (now < timer) continue;
    server.on_timer(now);
    batch.flush();
    timer = now + kTimerPeriod;
    if (!verbose || now < next_report) continue;
    report(server);
    next_report = now + kReportPeriod;
  }
}

std::unique_ptr<ServerObserver> make_observer(const ProgramOptions& options, const scene::Scene& scene,
                                              const time::Clock& clock) {
  if (options.record.empty()) return std::make_unique<LogObserver>(clock);
  record::RunInfo info;
  info.program = "forcebound-server " FORCEBOUND_VERSION;
  info.scene = scene.facts().name;
  info.simulated =
      (scene.accuracy() == nullptr ? "" : "accuracy auto, a level for each client; as it stands: ") + summary(scene);
  info.epoch = time::wall_clock_now() - clock.now();
  return std::make_unique<RecordingObserver>(clock, options.record, info);
}

}  // namespace

void serve(ProgramOptions options) {
  const time::SteadyClock clock;
  const scene::MeasureCost measure = measured_by(clock);
  const auto scene = load_scene(options.scene, scene::EffectRegistry::standard(), measure);
  SceneLibrary scenes = SceneLibrary::shipped(scene::EffectRegistry::standard(), measure);
  scenes.add(scene);
  SceneCompiler compiler(scenes);
  options.server.scene = scene->facts().name;

  stop_on_signals();
  auto link = net::UdpLink::listen(net::resolve(options.listen), net::UdpLink::Stamps::left_out);
  net::UdpBatch batch(link);
  const auto observer = make_observer(options, *scene, clock);
  Server server(options.server, std::move(scenes), batch, clock, random_session_id, observer.get());
  if (options.realtime) spdlog::info("{}", time::ask_for_real_time(kPriority).text);
  // After the time and the name, which take 24 columns.
  spdlog::info("{}", text::wrapped("listening on " + net::to_string(link.local_address()) + ", scene '" +
                                       scene->facts().name + "': " + summary(*scene),
                                   4, text::kColumns - 24));

  run(link, batch, server, compiler, clock, options.verbose);
  server.stop();
  batch.flush();
  std::cout << text::wrapped(server.counters().text(), 2);
  if (const auto lost = link.counters().overflowed; lost > 0) {
    std::cout << "socket: " << lost << " datagrams lost because it was full\n";
  }
  std::cout << std::flush;
}

}  // namespace forcebound::server
