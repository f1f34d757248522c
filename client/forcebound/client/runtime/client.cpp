#include "forcebound/client/runtime/client.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "forcebound/client/runtime/encryption.hpp"
#include "forcebound/client/runtime/event_queue.hpp"
#include "forcebound/client/runtime/priority.hpp"
#include "forcebound/client/runtime/stuck_loop.hpp"
#include "forcebound/client/runtime/tick_loop.hpp"
#include "forcebound/client/runtime/watchdog.hpp"
#include "forcebound/client/runtime/zero_force_first.hpp"
#include "forcebound/client/session/session.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/name_lookup.hpp"
#include "forcebound/net/peer_link.hpp"
#include "forcebound/record/idle_thread.hpp"
#include "forcebound/record/recorder.hpp"
#include "forcebound/record/recording_watch.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "forcebound/view/scene_parts.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::client {
namespace {

constexpr Nanoseconds kHousekeeping = std::chrono::milliseconds{50};
constexpr int kStuckLooks = 40;  // of housekeeping: 2 s
constexpr Nanoseconds kBuilding = std::chrono::milliseconds{2};

Client::Settings suited_to(const control::PassivityLaw& law, Client::Settings settings) {
  settings.renders_locally = settings.renders_locally && law.server_law().empty();
  return settings;
}

record::RunInfo run_info(const Client::Settings& settings, const device::HapticDevice& device,
                         const control::PassivityLaw& law, const time::Clock& clock, const std::string& server,
                         std::string_view encryption) {
  const control::DeviceFacts& facts = device.facts();
  record::RunInfo info;
  info.program = settings.program;
  info.law = settings.law.empty() ? std::string(law.name()) : settings.law;
  info.law_parameters = settings.law_parameters;
  info.device = facts.name;
  info.facts = device.facts_in_words();
  info.operator_name = settings.hand;
  info.hand = device.hand_in_words();
  info.scene = settings.scene;
  info.rendering = settings.renders_locally ? "local" : "remote";
  info.network = "server " + server + (settings.network.empty() ? "" : ", " + settings.network);
  info.encryption = encryption;
  info.seed = settings.seed;
  info.period = time::from_seconds(facts.period_s);
  info.hold = settings.policy.hold;
  info.drop = settings.policy.drop;
  info.audited = device.audit().has_value();
  info.device_simulated = device.is_simulated();
  info.guarantee = settings.guarantee;
  info.force_N_max = facts.force_N_max;
  info.epoch = time::wall_clock_now() - clock.now();
  return info;
}

/// Finds, where nothing is encrypted and the user has not accepted that, addresses of this machine alone; it throws
/// std::invalid_argument if the server is on another.
net::Resolver resolver_of(const Client::Settings& settings) {
  if (settings.identity.any() || settings.insecure) return settings.resolver;
  return [resolver = settings.resolver, server = settings.server](const net::Endpoint& endpoint) {
    std::vector<net::Address> found = resolver(endpoint);
    std::erase_if(found, [](const net::Address& address) { return !net::is_loopback(address); });
    if (!found.empty()) return found;
    throw std::invalid_argument("server " + server +
                                " is on another machine, and no keys are given; accepted are --server-key or "
                                "--known-servers, --psk, or --insecure if everybody on the way is trusted");
  };
}

/// Null: nothing is encrypted.
std::unique_ptr<Encryption> make_encryption(const Client::Settings& settings, net::DatagramLink& link,
                                            const time::Clock& clock) {
  if (!settings.identity.any()) return nullptr;
  return std::make_unique<Encryption>(settings.identity, settings.server, link, net::PeerLink::kPeer, clock);
}

/// Without a tick, before the watchdog stops the device: the time that it holds a force, and two ticks at least.
Nanoseconds longest_pause(const control::DeviceFacts& facts) {
  constexpr double kTicks = 2;
  return time::from_seconds(std::max(facts.hold_s_max, kTicks * facts.period_s));
}

/// Ends the loop's thread if an exception is thrown.
struct EndOfLoop {
  TickLoop& loop;
  ~EndOfLoop() { loop.end(); }
};

}  // namespace

struct Client::Parts {
  /// Real time: noexcept, no allocation.
  struct AmendedTicks final : record::TickSink {
    AmendedTicks(TickAmendment& its, std::vector<record::TickSink*> others) : by(its), sinks(std::move(others)) {}

    void on_tick(const record::TickRecord& tick) noexcept override {
      record::TickRecord amended = tick;
      by.amend(amended);
      for (record::TickSink* sink : sinks) sink->on_tick(amended);
    }
    void on_force(const record::ForceRecord& force) noexcept override {
      by.on_force(force);
      for (record::TickSink* sink : sinks) sink->on_force(force);
    }

    TickAmendment& by;
    std::vector<record::TickSink*> sinks;
  };

  Parts(const Settings& chosen, device::HapticDevice& its_device, std::unique_ptr<control::PassivityLaw> law,
        std::vector<record::TickSink*> others)
      : settings(suited_to(*law, chosen)),
        device(its_device),
        lookup(net::parse_endpoint(settings.server), resolver_of(settings)),
        link(lookup, clock, net::PeerLink::Found::by_session),
        encryption(make_encryption(settings, link, clock)),
        info(run_info(settings, device, *law, clock, lookup.in_words(),
                      encryption ? security::name_of(encryption->handshaker().pattern()) : "none")),
        summary(info),
        sinks(std::move(others)) {
    sinks.push_back(&summary);
    if (!settings.recording.empty()) {
      writer.emplace(settings.recording, info);
      for (const record::RecordedFile& file : settings.attachments) writer->attach(file, clock.now());
      sinks.push_back(&recorder);
    }
    if (settings.amendment != nullptr) {
      amended.emplace(*settings.amendment, std::move(sinks));
      sinks = {&*amended};
    }
    if (settings.renders_locally) {
      const auto rows = static_cast<std::uint32_t>(device.facts().translations());
      local.emplace(SceneBuilder::Options{.degrees_of_freedom = rows,
                                          .cache_folder = settings.scene_cache,
                                          .limits = handover::Limits::of_period(device.facts().period_s)});
    }
    session.emplace(Session::Options{.server = net::PeerLink::kPeer,
                                     .server_in_words = settings.server,
                                     .scene = settings.scene,
                                     .policy = settings.policy,
                                     .seed = settings.seed,
                                     .local = local ? &*local : nullptr,
                                     .force_slew_N_per_s = settings.force_slew_N_per_s,
                                     .torque_slew_N_m_per_s = settings.torque_slew_N_m_per_s,
                                     .send_rate = settings.send_rate},
                    device, std::move(law), encryption ? static_cast<net::DatagramLink&>(encryption->link()) : link,
                    clock, Session::Sinks{.ticks = sinks, .events = &events, .view = settings.view});
  }

  /// With the addresses of a server by name, which the handshake does not know.
  [[nodiscard]] std::string handshake_problem() const {
    std::string problem = encryption ? encryption->handshaker().problem() : std::string();
    if (!problem.empty() && lookup.is_name()) problem += "; " + lookup.in_words();
    return problem;
  }

  [[nodiscard]] std::string server_problem() const {
    std::string problem = handshake_problem();
    return problem.empty() ? lookup.problem() : problem;
  }

  /// What has come of the scene since the last call, as pictures show it. Not for the tick's thread.
  void record_scene() {
    if (!writer || !local) return;
    auto newest = local->builder().newest();
    if (!newest || newest == recorded_scene) return;
    recorded_scene = std::move(newest);
    const view::ShownScene shown = view::shown(*recorded_scene, view::Which::all);
    writer->write_scene(view::parts_of(shown), clock.now());
    writer->attach({.name = "scene.json", .media_type = "application/json", .content = view::scene_message(0, shown)},
                   clock.now());
  }

  /// Ends the process: the tick's thread, which is in the driver, cannot be ended alone. What that thread has in hand,
  /// the summary among it, is left alone.
  [[noreturn]] void leave(TickLoop& loop, const Watchdog& watchdog, const Lost& lost) {
    loop.end();
    if (writer) writer->flush();
    std::_Exit(lost ? lost(device.crash(), !watchdog.is_stopping()) : EXIT_FAILURE);
  }

  void finish(record::RunTotals totals) {
    if (writer) {
      recorder.drain(*writer);
      writer->flush();
      totals.recording_dropped = recorder.dropped();
      totals.recording_unwritten = writer->unwritten();
      if (!writer->problem().empty()) totals.notes.push_back(writer->problem());
      writer->finish(totals);
      // Only its end is missing then.
      if (totals.recording_unwritten == 0 && !writer->problem().empty()) totals.notes.push_back(writer->problem());
    }
    summary.finish(totals);
  }

  Settings settings;
  device::HapticDevice& device;
  time::SteadyClock clock;
  net::NameLookup lookup;
  net::PeerLink link;
  std::unique_ptr<Encryption> encryption;
  record::RunInfo info;
  record::Summary summary;
  record::Recorder recorder;
  std::optional<record::RecordingWriter> writer;
  EventQueue events;
  std::vector<record::TickSink*> sinks;
  std::optional<AmendedTicks> amended;  // has them then, and is the only one
  std::optional<LocalRendering> local;
  std::shared_ptr<const scene::Scene> recorded_scene;
  std::optional<Session> session;
  record::RecordingWatch recording_watch;
  std::string problem_reported;
  std::vector<std::string> notes;
  Nanoseconds began{0};
  GrantText grant;
  TickLoop::Outcome outcome;
};

Client::Client(const Settings& settings, device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law,
               std::vector<record::TickSink*> sinks)
    : parts_(std::make_unique<Parts>(settings, device, std::move(law), std::move(sinks))) {}

Client::~Client() = default;

void Client::run(const std::atomic<bool>& stop, const Housekeeping& housekeeping, const Lost& lost) {
  Parts& p = *parts_;
  p.device.start();
  ZeroForceFirst zero_force_first(p.device, *p.session, p.clock, p.settings.seed);
  std::optional<control::LastResortScope> scope;
  if (!p.settings.beside) scope.emplace(zero_force_first);
  record::IdleThread idle(p.clock, p.info.period, kTickPriority);
  std::optional<Watchdog> watchdog;
  if (!p.device.is_simulated()) watchdog.emplace(p.device, p.clock, longest_pause(p.device.facts()));
  TickLoop loop({.period = p.info.period,
                 .duration_s = p.settings.duration_s,
                 .once = p.settings.once,
                 .asks_again = p.settings.asks_again,
                 .watchdog = watchdog ? &*watchdog : nullptr,
                 .way = &p.link},
                *p.session, p.clock, p.grant, stop);
  const Nanoseconds start = p.clock.now();
  p.began = start;
  std::jthread building;
  if (p.local) {
    building = std::jthread([&builder = p.local->builder()](const std::stop_token& ended) {
      while (!ended.stop_requested()) {
        builder.work(ended);
        std::this_thread::sleep_for(kBuilding);
      }
    });
  }
  std::jthread tick([&loop] { loop.run(); });
  const EndOfLoop end{loop};
  StuckLoop stuck_loop(kStuckLooks);
  while (!loop.done()) {
    std::this_thread::sleep_for(kHousekeeping);
    p.record_scene();
    if (p.writer) p.recorder.drain(*p.writer);
    const Nanoseconds now = p.clock.now();
    if (housekeeping) housekeeping(now, now - start);
    const bool stuck = stuck_loop.update(loop.rounds());
    const bool gone = (stuck || !p.device.crash().empty()) && !p.settings.outlives_device;
    if (watchdog && gone) p.leave(loop, *watchdog, lost);
  }
  tick.join();
  if (p.local) {
    building.request_stop();
    building.join();
  }
  p.outcome = loop.outcome();
  const std::uint64_t watchdog_stops = watchdog ? watchdog->stops() : 0;
  watchdog.reset();

  record::RunTotals totals = p.session->totals();
  totals.notes.insert(totals.notes.end(), p.notes.begin(), p.notes.end());
  totals.idle_timer = idle.stop();
  totals.tick_allocations = p.outcome.allocations;
  totals.missed_ticks = p.outcome.missed_ticks;
  totals.watchdog_stops = watchdog_stops;
  totals.events_dropped = p.events.dropped();
  totals.datagrams_overflowed = p.link.counters().overflowed;
  totals.port_unreachable = p.link.counters().refused;
  p.finish(std::move(totals));
}

EventQueue& Client::events() noexcept { return parts_->events; }
std::string Client::take_recording_fault() {
  return parts_->writer ? parts_->recording_watch.take(parts_->recorder, *parts_->writer) : std::string();
}

std::string Client::take_server_news() {
  Parts& p = *parts_;
  if (const std::string found = p.link.take_news(); !found.empty()) {
    add_note(found);
    return found;
  }
  return p.encryption ? p.encryption->handshaker().take_news() : std::string();
}

std::string Client::take_server_problem() {
  Parts& p = *parts_;
  std::string problem = p.server_problem();
  if (problem == p.problem_reported) return {};
  p.problem_reported = problem;
  return problem;
}

std::string Client::server_in_words() const { return parts_->lookup.in_words(); }

void Client::add_note(const std::string& line) {
  constexpr std::size_t kNotesMost = 100;
  Parts& p = *parts_;
  if (p.notes.size() == kNotesMost) return;
  p.notes.push_back("at " + text::fixed(time::to_seconds(p.clock.now() - p.began), 3) + " s: " + line);
}

std::shared_ptr<const scene::Scene> Client::scene_here() const {
  return parts_->local ? parts_->local->builder().newest() : nullptr;
}

bool Client::recording_complete() const {
  const Parts& p = *parts_;
  return !p.writer || (p.recorder.dropped() == 0 && p.writer->problem().empty());
}

const record::Summary& Client::summary() const noexcept { return parts_->summary; }
const std::string* Client::real_time_grant() const noexcept { return parts_->grant.text(); }

std::string Client::why_no_session() const {
  if (!parts_->outcome.gave_up) return {};
  if (parts_->session->refused()) return server_in_words() + " refused";
  if (std::string problem = parts_->handshake_problem(); !problem.empty()) return problem;
  const bool unreachable = parts_->link.counters().refused > 0;
  return "no answer from " + server_in_words() + (unreachable ? ": port unreachable (ICMP)" : "");
}

}  // namespace forcebound::client
