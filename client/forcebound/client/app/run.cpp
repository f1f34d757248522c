#include "forcebound/baselines/baselines.hpp"
#include "forcebound/client/app/run.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "forcebound/baselines/law_file.hpp"
#include "forcebound/client/app/event_queue.hpp"
#include "forcebound/client/app/idle_timer.hpp"
#include "forcebound/client/app/live_line.hpp"
#include "forcebound/client/app/screen.hpp"
#include "forcebound/client/session/session.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_link.hpp"
#include "forcebound/record/recorder.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/heap_operations.hpp"
#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

constexpr int kPriority = 80;
constexpr Nanoseconds kHousekeeping = 50ms;
constexpr Nanoseconds kOncePatience = 5s;
constexpr Nanoseconds kClosing = 3s;
constexpr int kSettlingTicks = 1000;  // the first second may still touch memory for the first time

/// Everything that the tick's thread owns, and what it tells the others.
struct Loop {
  const Options& options;
  const std::atomic<bool>& stop;
  const time::SteadyClock& clock;
  Session& session;
  Nanoseconds period;
  std::string grant{};
  std::uint64_t allocations = 0;
  std::uint64_t missed_ticks = 0;
  bool gave_up = false;
  std::atomic<bool> done{false};

  void run() {
    const auto granted = time::ask_for_real_time(kPriority);
    grant = granted.text;
    time::touch_stack();
    const Nanoseconds start = clock.now();
    time::PeriodicTimer timer(clock, period);
    std::uint64_t ticks = 0;
    std::uint64_t allocations_at_start = 0;
    for (Nanoseconds now = timer.wait(); !stop && !over(now - start); now = timer.wait()) {
      session.tick(now);
      if (++ticks == kSettlingTicks) allocations_at_start = time::heap_operations_of_this_thread();
    }
    if (ticks > kSettlingTicks) allocations = time::heap_operations_of_this_thread() - allocations_at_start;
    missed_ticks = timer.missed();
    const Nanoseconds closing = clock.now();
    for (Nanoseconds now = timer.wait(); !session.close(now) && now - closing < kClosing; now = timer.wait()) {
    }
    done = true;
  }

  bool over(Nanoseconds elapsed) {
    const bool ended = options.duration_s > 0 && time::to_seconds(elapsed) >= options.duration_s;
    const bool unanswered = session.state() == SessionState::connecting && (ended || elapsed > kOncePatience);
    gave_up = options.once && (session.refused() || unanswered);
    return gave_up || ended;
  }
};

std::ofstream open_summary(const std::string& file) {
  std::ofstream out;
  if (file.empty()) return out;
  out.open(file);
  if (!out)
    throw std::runtime_error("cannot write the summary to '" + file + "': " + std::generic_category().message(errno));
  return out;
}

/// What only the shell around the session counts.
void note_shell_faults(record::RunTotals& totals, const Loop& loop, const device::SimulatedDevice& device,
                       const net::UdpLink& link, const EventQueue& events) {
  totals.tick_allocations = loop.allocations;
  totals.missed_ticks = loop.missed_ticks;
  totals.device_gaps_cut = device.counters().gaps_cut;
  totals.device_frozen_joints = device.counters().frozen_joints;
  totals.device_faulty_commands = device.counters().faulty_commands;
  totals.events_dropped = events.dropped();
  totals.datagrams_overflowed = link.counters().overflowed;
  totals.nobody_listening = link.counters().refused;
}

std::string why_no_session(const Options& options, const Session& session, const net::UdpLink& link) {
  if (session.refused()) return options.server + " refused";
  return "no answer from " + options.server + (link.counters().refused > 0 ? ": nobody listens there" : "");
}

control::LawOptions law_options(const Options& options, const control::LawRegistry& laws) {
  control::LawOptions chosen = options.law_options;
  if (!options.law_parameters.empty()) {
    chosen.parameters = baselines::load_law_parameters(options.law_parameters, options.law, laws);
  }
  return chosen;
}

record::RunInfo run_info(const Options& options, const device::SimulatedDevice& device, const time::Clock& clock) {
  record::RunInfo info;
  info.program = "forcebound-client " FORCEBOUND_VERSION;
  info.law = options.law;
  info.device = device.facts().name;
  info.facts = device::describe(device.description());
  info.operator_name = options.hand;
  info.hand = device.hand().description();
  info.scene = options.scene;
  info.network = "server " + options.server;
  info.seed = options.seed;
  info.period = time::from_seconds(device.facts().period_s);
  info.hold = options.policy.hold;
  info.drop = options.policy.drop;
  info.force_N_max = device.facts().force_N_max;
  info.audited = device.audit().has_value();
  info.device_simulated = true;
  info.epoch = time::wall_clock_now() - clock.now();
  return info;
}

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  const time::SteadyClock clock;
  const control::LawRegistry laws = baselines::shipped_laws();
  device::DeviceDescription description = device::load_device(options.device);
  if (!options.law_help.empty()) {
    std::fputs(text::wrapped_help(laws.help(options.law_help, description.facts)).c_str(), stdout);
    return 0;
  }
  auto hand = device::make_operator(options.hand, description.facts.degrees_of_freedom());
  device::SimulatedDevice device(std::move(description), std::move(hand));
  const control::LawOptions chosen = law_options(options, laws);
  auto law = laws.make(options.law, device.facts(), chosen);
  const net::Address server = net::resolve(net::parse_endpoint(options.server));
  net::UdpLink link = net::UdpLink::towards(server);
  std::ofstream summary_file = open_summary(options.summary);

  record::RunInfo info = run_info(options, device, clock);
  info.law_parameters = baselines::describe(laws.parameters(options.law, device.facts(), chosen.parameters));
  info.guarantee = laws.guarantee(options.law);
  spdlog::info("device '{}' and its hand '{}' are simulated; law {}, server {}", info.device, options.hand, options.law,
               options.server);
  std::optional<record::RecordingWriter> writer;
  if (!options.record.empty()) writer.emplace(options.record, info);
  record::Summary summary(info);
  record::Recorder recorder;
  LiveLine line;
  EventQueue events;
  std::vector<record::TickSink*> sinks{&summary, &line};
  if (writer) sinks.push_back(&recorder);
  Session session({.server = server, .scene = options.scene, .policy = options.policy, .seed = options.seed}, device,
                  std::move(law), link, clock, {.ticks = sinks, .events = &events});

  IdleTimer idle(clock, info.period, kPriority);
  Loop loop{.options = options, .stop = stop, .clock = clock, .session = session, .period = info.period};
  Screen screen(options, line, events);
  const Nanoseconds start = clock.now();
  std::jthread tick([&loop] { loop.run(); });
  while (!loop.done) {
    std::this_thread::sleep_for(kHousekeeping);
    if (writer) recorder.drain(*writer);
    screen.refresh(clock.now(), clock.now() - start);
  }
  tick.join();
  screen.end(clock.now());
  spdlog::info("tick thread: {}", loop.grant);

  record::RunTotals totals = session.totals();
  note_shell_faults(totals, loop, device, link, events);
  totals.idle_timer = idle.stop();
  totals.recording_dropped = recorder.dropped();
  if (writer) {
    recorder.drain(*writer);
    writer->flush();
    totals.recording_unwritten = writer->unwritten();
    if (!writer->problem().empty()) totals.notes.push_back(writer->problem());
    writer->finish(totals);
  }
  summary.finish(totals);
  std::fputs(summary.to_text(text::colour_for(STDOUT_FILENO)).c_str(), stdout);
  bool failed = loop.gave_up;
  if (summary_file.is_open()) {
    summary_file << summary.to_json();
    if (!summary_file.flush()) {
      spdlog::error("could not write all of the summary to '{}': {}", options.summary,
                    std::generic_category().message(errno));
      failed = true;
    }
  }
  if (loop.gave_up) spdlog::error("gave up: {}", why_no_session(options, session, link));
  return failed ? 1 : 0;
}

}  // namespace forcebound::client
