#include "forcebound/server/app/serve.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/program/command_line.hpp"
#include "forcebound/server/app/build_scene.hpp"
#include "forcebound/server/app/log_observer.hpp"
#include "forcebound/server/app/recording_observer.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/runtime/udp_server.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::server {
namespace {

constexpr Nanoseconds kReportPeriod = std::chrono::seconds{10};
// Below the priority of a client on the same machine, whose deadline is hard.
constexpr int kPriority = 40;

volatile std::sig_atomic_t stop_wanted = 0;

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_wanted = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A full disk or a closed pipe gives a write error, not a signal that ends the process.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void report(const Server& server) {
  const ServerCounters counters = server.counters();
  spdlog::info("{}, {} received, {} sent, {} in all", text::counted(server.sessions(), "session"),
               text::counted(counters.motions_received, "motion"), text::counted(counters.forces_sent, "force"),
               text::counted(counters.datagrams, "datagram"));
}

void run(UdpServer& server, const time::Clock& clock, bool verbose) {
  Nanoseconds next_report = clock.now() + kReportPeriod;
  while (stop_wanted == 0) {
    server.turn();
    if (!verbose || clock.now() < next_report) continue;
    report(server.server());
    next_report = clock.now() + kReportPeriod;
  }
}

std::unique_ptr<LogObserver> make_observer(const ProgramOptions& options, const scene::Scene& scene,
                                           const std::string& encryption, const time::Clock& clock) {
  if (options.record.empty()) return std::make_unique<LogObserver>(clock);
  record::RunInfo info;
  info.program = "forcebound-server " FORCEBOUND_VERSION;
  info.scene = scene.facts().name;
  info.simulated =
      (scene.accuracy() == nullptr ? "" : "accuracy auto, a level for each client; the file's: ") + summary(scene);
  info.encryption = encryption;
  info.epoch = time::wall_clock_now() - clock.now();
  return std::make_unique<RecordingObserver>(clock, options.record, info);
}

std::string totals(const UdpServer& server, const std::string& encryption) {
  std::string text = server.server().counters().text() + "encryption: " + encryption + "\n";
  if (server.encryption() != nullptr) text += server.encryption()->counters().text();
  return text;
}

}  // namespace

int serve(ProgramOptions options) {
  const net::Address address = net::resolve(options.listen);
  expect_encryption(options.keys, address);
  std::optional<ServerKeys> keys = read_keys(options.keys);
  const std::string encryption = encryption_name(keys);
  const std::string encryption_words = encryption_in_words(options.keys, keys);
  const time::SteadyClock clock;
  const scene::MeasureCost measure = measured_by(clock);
  const auto scene = build_scene(options, measure);
  SceneLibrary scenes = SceneLibrary::shipped(scene::Registry::standard(), measure);
  scenes.add(scene);
  options.server.scene = scene->facts().name;
  for (const std::string& name : options.server.scenes) {
    const auto known = scenes.all_names();
    if (std::ranges::find(known, name) == known.end()) {
      throw std::invalid_argument("--scenes: no scene '" + name + "'" + text::suggestion(name, known));
    }
  }

  stop_on_signals();
  auto link = listen_at(address);
  const auto observer = make_observer(options, *scene, encryption, clock);
  UdpServer server(std::move(link), options.server, scenes, observer.get(), std::move(keys));
  spdlog::info("{}", encryption_words);
  if (options.realtime) spdlog::info("{}", time::ask_for_real_time(kPriority).text);
  spdlog::info("listening on {}, scene '{}': {}", net::to_string(server.address()), scene->facts().name,
               summary(*scene));

  run(server, clock, options.verbose);
  server.stop();
  std::cout << text::wrapped(totals(server, encryption), 2);
  if (server.overflowed() > 0) {
    std::cout << "socket: " << text::counted(server.overflowed(), "datagram") << " lost because it was full\n";
  }
  std::cout << std::flush;
  return observer->finish() ? program::kDone : program::kOutputLost;
}

}  // namespace forcebound::server
