#include "forcebound/server/app/serve.hpp"

#include <sched.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/program/command_line.hpp"
#include "forcebound/security/allowed_clients.hpp"
#include "forcebound/server/app/build_scene.hpp"
#include "forcebound/server/app/fleet_link.hpp"
#include "forcebound/server/app/led_robot.hpp"
#include "forcebound/server/app/log_observer.hpp"
#include "forcebound/server/app/page_observer.hpp"
#include "forcebound/server/app/page_turn.hpp"
#include "forcebound/server/app/processor_quota.hpp"
#include "forcebound/server/app/recording_observer.hpp"
#include "forcebound/server/app/service_manager.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/runtime/server_workers.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::server {
namespace {

constexpr Nanoseconds kReportPeriod = std::chrono::seconds{10};
// Below the priority of a client on the same machine, whose deadline is hard.
constexpr int kPriority = 40;
// Above that: a robot's deadline is hard too.
constexpr int kRobotPriority = 60;

// What signals ask for. Any thread may get a signal, a resolver's too.
std::atomic<bool> interrupted{false};
std::atomic<int> terminations{0};
std::atomic<bool> reload_asked{false};
std::atomic<bool> bias_asked{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

void install_signal_handlers(bool reloadable, bool drives_robot) {
  const auto handle = [](int signal, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    sigaction(signal, &action, nullptr);
  };
  handle(SIGINT, [](int) { interrupted = true; });
  // A second one ends at once.
  constexpr auto kTerminate = [](int) { terminations = terminations == 0 ? 1 : 2; };
  handle(SIGTERM, kTerminate);
  // Whatever ends the process, the robot is to be stopped before.
  if (drives_robot) {
    handle(SIGHUP, kTerminate);
    handle(SIGQUIT, kTerminate);
    handle(SIGUSR1, [](int) { bias_asked = true; });
  }
  // Otherwise it means that the terminal is gone.
  if (reloadable) handle(SIGHUP, [](int) { reload_asked = true; });
  // A full disk or a closed pipe gives a write error, not a signal that ends the process.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void report(const ServerWorkers& server) {
  const ServerCounters counters = server.counters();
  spdlog::info("{}, {} received, {} sent, {} in all", text::counted(server.sessions(), "session"),
               text::counted(counters.motions_received, "motion"), text::counted(counters.forces_sent, "force"),
               text::counted(counters.datagrams, "datagram"));
}

/// What the system refuses is a warning: the server serves, as well as what else runs here lets it.
void ask_for_real_time() {
  const time::RealTimeGrant grant = time::ask_for_real_time(kPriority);
  if (grant.first_in_first_out && grant.memory_locked) {
    spdlog::info("{}", grant.text);
  } else {
    spdlog::warn(
        "--realtime is {}: {}; answers are late whenever {}. A service needs LimitRTPRIO={} and LimitMEMLOCK=infinity, "
        "a container the capabilities SYS_NICE and IPC_LOCK",
        grant.first_in_first_out ? "granted in part" : "not granted", grant.text,
        grant.first_in_first_out ? "memory is read again from a disk" : "the machine is busy", kPriority);
  }
}

/// For a further worker's thread, which need not inherit the first one's scheduling. What systemd has given to that one
/// may be refused to others, where its limit is lower.
void ask_for_scheduling() {
  const int refused = time::ask_for_first_in_first_out(kPriority);
  static std::atomic_flag reported;
  if (refused == 0 || reported.test_and_set()) return;
  spdlog::warn(
      "further workers have no SCHED_FIFO ({}): their answers are late whenever the machine is busy. A service needs "
      "LimitRTPRIO={}",
      std::strerror(refused), kPriority);
}

/// What clients can request, and what those get that request nothing.
struct Offer {
  SceneLibrary scenes{};
  EnvironmentLibrary environments{};  ///< the scenes and the robot
  std::string name{};                 ///< of what is served by default
  std::string simulated{};            ///< in a line
  std::string choice{};               ///< before that, in recordings
  std::unique_ptr<LedRobot> robot{};  ///< null: a scene
};

/// The file of clients again; the one before stays where it cannot be read.
void reload(ServerWorkers& server, const ProgramOptions& options, const Offer& offer) {
  if (options.keys.clients.empty()) {
    spdlog::warn("nothing to read again: there is no --clients");
    return;
  }
  std::optional<security::AllowedClients> clients;
  try {
    clients = security::AllowedClients::from_file(options.keys.clients, offer.environments.names());
  } catch (const std::exception& error) {
    spdlog::error("{}; the clients are those of before", error.what());
    return;
  }
  try {
    server.replace_clients(*clients);
    spdlog::info("{} read again: {}", options.keys.clients, text::counted(clients->all().size(), "client"));
  } catch (const std::exception& error) {
    spdlog::error("{}; clients of before may still be let in: have {} read again", error.what(), options.keys.clients);
  }
}

/// What runs beside the server and a robot, on its thread; null: it is not there.
struct Beside {
  PageTurn* page = nullptr;
  FleetLink* fleet = nullptr;
};

/// Serves until a signal or the fleet ends it, and then until all clients have left or the time for that is over.
class Service {
 public:
  Service(ServerWorkers& server, const Offer& offer, const Beside& beside, const ProgramOptions& options,
          const time::Clock& clock, ServiceManager& manager)
      : server_(server),
        offer_(offer),
        beside_(beside),
        options_(options),
        clock_(clock),
        manager_(manager),
        next_report_(clock.now() + kReportPeriod) {}

  void run() {
    while (!over()) {
      server_.turn();
      if (beside_.page != nullptr) beside_.page->turn(server_);
      if (beside_.fleet != nullptr) beside_.fleet->turn(server_.sessions());
      if (offer_.robot) attend(*offer_.robot);
      if (server_.alive(clock_.now())) manager_.report_alive(clock_.now());
      if (reload_asked) reload_now();
      if (reloading_ && server_.settled()) report_reloaded();
      if (options_.verbose && clock_.now() >= next_report_) {
        report(server_);
        next_report_ = clock_.now() + kReportPeriod;
      }
    }
    ServiceManager::report_stopping("ending");
  }

 private:
  bool over() {
    if (interrupted || terminations > 1) return true;
    if (offer_.robot && offer_.robot->is_lost()) return leader_told();
    if (terminations == 0 && (beside_.fleet == nullptr || !beside_.fleet->over())) return false;
    if (options_.drain == Nanoseconds{0} || server_.sessions() == 0) return true;
    if (!drained_by_) begin_to_drain();
    return clock_.now() >= *drained_by_;
  }

  /// Whether the leader of a robot that is lost knows why its session ends: answers say so from then on. Several, as
  /// the network may lose some; a leader that is silent is not waited for.
  bool leader_told() {
    constexpr std::uint64_t kAnswers = 10;
    constexpr Nanoseconds kPatience = std::chrono::milliseconds{500};
    const std::uint64_t answers = server_.counters().forces_sent;
    if (!told_by_) {
      told_by_ = clock_.now() + kPatience;
      told_with_ = answers + kAnswers;
    }
    return server_.sessions() == 0 || answers >= told_with_ || clock_.now() >= *told_by_;
  }

  void begin_to_drain() {
    drained_by_ = clock_.now() + options_.drain;
    server_.admit_none("the server is about to end and takes no more clients; try again later");
    const std::string words = "ending: waiting up to " + text::to_text(time::to_seconds(options_.drain)) + " s for " +
                              text::counted(server_.sessions(), "session");
    spdlog::info("{}; a second SIGTERM ends at once", words);
    ServiceManager::report_stopping(words);
  }

  static void attend(LedRobot& robot) {
    if (bias_asked.exchange(false)) robot.learn_bias();
    robot.log_changes();
  }

  void reload_now() {
    reload_asked = false;
    ServiceManager::report_reloading();
    reload(server_, options_, offer_);
    reloading_ = true;
  }

  /// All workers have the new list.
  void report_reloaded() {
    reloading_ = false;
    if (!drained_by_) ServiceManager::report_ready("serving");
  }

  ServerWorkers& server_;
  const Offer& offer_;
  Beside beside_;
  const ProgramOptions& options_;
  const time::Clock& clock_;
  ServiceManager& manager_;
  Nanoseconds next_report_;
  std::optional<Nanoseconds> drained_by_{};
  std::optional<Nanoseconds> told_by_{};
  std::uint64_t told_with_ = 0;  ///< so many answers to all clients
  bool reloading_ = false;
};

/// @throws std::exception if scene or robot are not available
Offer make_offer(const ProgramOptions& options, const time::Clock& clock) {
  const scene::MeasureCost measure = measured_by(clock);
  Offer offer{.scenes = SceneLibrary::shipped(scene::Registry::standard(), measure)};
  if (options.start_robot) {
    offer.robot = options.start_robot(options.server.laws, clock,
                                      options.realtime ? std::optional(kRobotPriority) : std::nullopt);
    EnvironmentKind kind = offer.robot->environment();
    offer.name = kind.name;
    offer.simulated = offer.robot->summary();
    offer.environments = offer.scenes;
    offer.environments.add(std::move(kind));
  } else {
    const auto scene = build_scene(options, measure);
    offer.scenes.add(scene);
    offer.name = scene->facts().name;
    offer.simulated = summary(*scene);
    if (scene->accuracy() != nullptr) offer.choice = "accuracy auto, a level for each client; the file's: ";
    offer.environments = offer.scenes;
  }
  for (const std::string& name : options.server.scenes) {
    const auto known = offer.scenes.all_names();
    if (std::ranges::find(known, name) == known.end()) {
      throw std::invalid_argument("--scenes: no scene '" + name + "'" + text::suggestion(name, known));
    }
  }
  return offer;
}

std::unique_ptr<LogObserver> make_observer(const ProgramOptions& options, const Offer& offer,
                                           const std::string& encryption, const time::Clock& clock) {
  if (options.record.empty()) return std::make_unique<LogObserver>(clock);
  record::RunInfo info;
  info.program = "forcebound-server " FORCEBOUND_VERSION;
  info.scene = offer.name;
  info.simulated = offer.choice + offer.simulated;
  info.encryption = encryption;
  info.epoch = time::wall_clock_now() - clock.now();
  RecordingObserver::Scenes scenes{.library = offer.scenes};
  if (!offer.robot) scenes.text = scene_source(options.scene).text;
  return std::make_unique<RecordingObserver>(clock, options.record, info, std::move(scenes));
}

std::string totals(const ServerWorkers& server, const std::string& encryption) {
  std::string text = server.counters().text() + "encryption: " + encryption + "\n";
  if (const auto secure = server.secure_counters()) text += secure->text();
  if (const std::uint64_t handed_over = server.handed_over(); handed_over > 0) {
    text += text::counted(handed_over, "datagram") + " handed over from one worker to another\n";
  }
  if (const std::uint64_t lost = server.not_handed_over(); lost > 0) {
    text += text::counted(lost, "datagram") + " lost since a worker had no room for more from others\n";
  }
  if (const std::uint64_t lost = server.keys_not_moved(); lost > 0) {
    text += text::counted(lost, "datagram") + " lost since the keys of their clients moved between workers too often\n";
  }
  return text;
}

void log_workers(std::size_t wanted, std::size_t has) {
  if (has > 1) spdlog::info("{} workers", has);
  if (has >= wanted) return;
  spdlog::warn(
      "{} instead of {}: the system lets no filter choose among sockets at one address (SO_REUSEPORT with "
      "SO_ATTACH_REUSEPORT_CBPF)",
      text::counted(has, "worker"), wanted);
}

/// How many threads serve.
/// @throws std::invalid_argument where several were asked for and cannot be
std::size_t workers_for(const ProgramOptions& options, bool socket_handed_over) {
  if (options.start_robot || socket_handed_over) {
    if (options.workers > 1) {
      throw std::invalid_argument("--workers must be 1 with " +
                                  std::string(socket_handed_over ? "a socket from the service manager, which has bound "
                                                                   "one for one worker"
                                                                 : "--follower: a robot has one leader") +
                                  ", got " + std::to_string(options.workers));
    }
    return 1;
  }
  if (options.workers > 0) return options.workers;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 1;
  const double processors = std::min<double>(CPU_COUNT(&allowed), processor_quota().value_or(CPU_SETSIZE));
  // With a quota of 1.5 a second worker would be kept waiting for a quarter of each period.
  return std::clamp<std::size_t>(static_cast<std::size_t>(processors), 1, WorkerPlace::kWorkersMost);
}

}  // namespace

int serve(ProgramOptions options) {
  ServiceManager manager;
  const auto port_of_fleet = fleet_port();
  std::optional<net::UdpLink> handed_over = ServiceManager::take_socket();
  const std::size_t workers = workers_for(options, handed_over.has_value());
  const net::Address address = handed_over ? handed_over->local_address() : net::resolve(options.listen);
  expect_encryption(options.keys, address);
  const time::SteadyClock clock;
  Offer offer = make_offer(options, clock);
  options.server.scene = offer.name;
  std::optional<ServerKeys> keys = read_keys(options.keys, offer.environments.names());
  const std::string encryption = encryption_name(keys);
  const std::string encryption_words = encryption_in_words(options.keys, keys);

  install_signal_handlers(!options.keys.clients.empty() || ServiceManager::started_this(), offer.robot != nullptr);
  net::UdpLink link = handed_over ? std::move(*handed_over) : listen_at(address);
  const auto observer = make_observer(options, offer, encryption, clock);
  PageObserver page_observer(*observer, clock);
  ServerObserver& told = options.page ? static_cast<ServerObserver&>(page_observer) : *observer;
  ServerWorkers server(std::move(link),
                       {.workers = workers,
                        .observes_motions = options.page.has_value() || !options.record.empty(),
                        .begin_thread = options.realtime ? ask_for_scheduling : nullptr},
                       options.server, offer.environments, &told, std::move(keys));
  spdlog::info("{}", encryption_words);
  // Before: its thread is to have no real-time priority.
  std::optional<PageTurn> page;
  if (options.page) page.emplace(options, page_observer, clock, offer.robot.get(), offer.scenes, offer.name);
  std::optional<FleetLink> fleet;
  if (port_of_fleet) {
    const FleetMember::Options member{.after_use = options.after_use, .places = options.server.sessions_max};
    fleet.emplace(FleetLink::Settings{.port = *port_of_fleet, .member = member}, clock);
  }
  if (options.realtime) ask_for_real_time();
  server.start();
  log_workers(workers, server.size());
  spdlog::info("listening on {}, {} '{}': {}", net::to_string(server.address()), offer.robot ? "task" : "scene",
               offer.name, offer.simulated);

  ServiceManager::report_ready("serving at " + net::to_string(server.address()));

  const Beside beside{.page = page ? &*page : nullptr, .fleet = fleet ? &*fleet : nullptr};
  Service(server, offer, beside, options, clock, manager).run();
  server.stop();
  fleet.reset();
  if (offer.robot) offer.robot->stop();
  std::cout << text::wrapped(totals(server, encryption), 2);
  if (server.overflowed() > 0) {
    std::cout << "socket: " << text::counted(server.overflowed(), "datagram") << " lost because it was full\n";
  }
  std::cout << std::flush;
  if (offer.robot) std::cout << text::wrapped(offer.robot->totals(), 4) << std::flush;
  if (offer.robot && offer.robot->is_lost()) {
    (void)observer->finish();
    spdlog::shutdown();
    // Its thread is in the driver, for ever.
    std::_Exit(offer.robot->has_crashed() ? program::kDriverCrashed : program::kFailed);
  }
  return observer->finish() ? program::kDone : program::kOutputLost;
}

}  // namespace forcebound::server
