#include "tests/tools/sim/closed_loop.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "forcebound/baselines/law_file.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_environment.hpp"
#include "tests/tools/sim/building_time.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kServerTimer = 250ms;
constexpr Nanoseconds kClosing = 30s;  // virtual time

/// With the laws, and with local rendering only where the law allows it, as a client has it.
ClosedLoop::Settings completed(ClosedLoop::Settings settings) {
  if (!settings.laws) settings.laws = std::make_shared<const control::LawRegistry>(law_plugin::known_laws());
  if (settings.laws->find(settings.law).make_server_side) settings.renders_locally = false;
  return settings;
}

}  // namespace

ClosedLoop::ClosedLoop(Settings settings, const std::vector<record::TickSink*>& sinks)
    : settings_(completed(std::move(settings))),
      tick_clock_(clock_),
      server_clock_(clock_, settings_.server_clock),
      schedule_(settings_.timing, time::from_seconds(settings_.device.facts.period_s), settings_.seed),
      network_(clock_, settings_.network),
      busy_(settings_.server_turn),
      device_(
          settings_.device,
          settings_.make_hand ? settings_.make_hand() : device::make_operator(settings_.hand, settings_.device.facts),
          settings_.flaws),
      surface_(settings_.own_environment ? nullptr : settings_.scene, device_),
      summary_(info()) {
  if (settings_.told) described_.emplace(device_, *settings_.told);
  surface_.hand_on_to(sinks);
  surface_.hand_on_to({&summary_});
  network_.set_server_handler([this](std::span<const std::byte> datagram, const Address& from, Nanoseconds now) {
    if (!server_) return;
    if (settings_.server_turn > Nanoseconds{0}) {
      busy_.arrive(datagram, from, now);
    } else {
      server_->on_datagram(datagram, from, server_clock_.shown_at(now));
    }
  });
  start_server();
  if (settings_.renders_locally) {
    local_.emplace(client::SceneBuilder::Options{
        .degrees_of_freedom = static_cast<std::uint32_t>(settings_.device.facts.translations()),
        .cache_folder = settings_.scene_cache,
        .limits = handover::Limits::of_period(settings_.device.facts.period_s)});
  }
  session_ = std::make_unique<client::Session>(
      client::Session::Options{.server = network_.server_address(),
                               .policy = settings_.policy,
                               .seed = settings_.seed,
                               .local = local(),
                               .force_slew_N_per_s = settings_.force_slew_N_per_s,
                               .send_rate = settings_.send_rate},
      device_as_described(), settings_.laws->make(settings_.law, device_as_described().facts(), settings_.law_options),
      network_.add_client(), tick_clock_, client::Session::Sinks{.ticks = session_sinks_});
}

ClosedLoop::~ClosedLoop() = default;

record::RunInfo ClosedLoop::info() const {
  record::RunInfo info;
  info.program = "virtual time";
  info.law = settings_.law;
  info.law_parameters = baselines::describe(
      settings_.laws->parameters(settings_.law, settings_.device.facts, settings_.law_options.parameters));
  info.device = settings_.device.facts.name;
  info.facts = describe(settings_.device);
  info.operator_name = settings_.make_hand ? std::string(device_.hand().name()) : settings_.hand;
  info.hand = device_.hand().description();
  if (settings_.scene) {
    info.scene = settings_.scene->facts().name;
    info.simulated = server::summary(*settings_.scene);
  }
  if (settings_.own_environment) info.simulated = settings_.own_environment->name;
  info.rendering = settings_.renders_locally ? "local" : "remote";
  info.seed = settings_.seed;
  info.period = time::from_seconds(settings_.device.facts.period_s);
  info.hold = settings_.policy.hold;
  info.drop = settings_.policy.drop;
  info.force_N_max = settings_.device.facts.force_N_max;
  info.settle_s = settings_.settle_s;
  info.audited = true;
  info.device_simulated = true;
  info.surface_true = surface_.known();
  info.guarantee = settings_.laws->guarantee(settings_.law);
  return info;
}

void ClosedLoop::start_server() {
  server::EnvironmentKind scene =
      settings_.own_environment ? *settings_.own_environment : server::scene_environment(settings_.scene);
  if (settings_.scene) scene.name = settings_.scene->facts().name;
  const std::string name = scene.name;
  if (settings_.handed_over) {
    scene.make = [honest = std::move(scene.make),
                  packed = handover::pack(*settings_.handed_over)](const server::ClientFacts& client) {
      server::MadeEnvironment made = honest(client);
      made.packed = packed;
      return made;
    };
  }
  server::EnvironmentLibrary environments;
  environments.add(settings_.environment
                       ? taken_over(std::move(scene), *settings_.environment, [this] { return truth(); })
                       : std::move(scene));
  server_ = std::make_unique<server::Server>(
      server::ServerOptions{.scene = name, .handover = settings_.handover, .laws = *settings_.laws},
      std::move(environments), network_.server_link(), server_clock_,
      [random = std::mt19937_64(settings_.seed + ++server_starts_)]() mutable { return random() | 1U; });
  network_.attach_server();
}

void ClosedLoop::kill_server() {
  network_.detach_server();
  busy_.forget();
  server_.reset();
}

void ClosedLoop::live_until(Nanoseconds time) {
  // The server reads the clock too: set it to the arrival of each datagram.
  while (true) {
    const auto arrival = network_.next_event();
    const auto turn = busy_.next_event();
    const Nanoseconds next = std::min(arrival.value_or(Nanoseconds::max()), turn.value_or(Nanoseconds::max()));
    if (next > time) break;
    clock_.set(std::max(next, clock_.now()));
    if (turn == next) end_server_turn();
    network_.deliver_due(clock_.now());
  }
  clock_.set(time);
}

void ClosedLoop::end_server_turn() {
  busy_.end_turn([this](std::span<const std::byte> datagram, const Address& from, Nanoseconds arrival) {
    server_->receive(datagram, {.address = from}, server_clock_.shown_at(arrival));
  });
  server_->answer_waiting();
}

void ClosedLoop::run_until(Nanoseconds end) {
  for (end_ = std::max(end_, end); next_tick_ < end_; plan_next_tick()) {
    live_until(next_tick_);
    apply_faults();
    if (server_ && next_tick_ >= next_timer_) {
      server_->on_timer(server_clock_.now());
      next_timer_ += kServerTimer;
    }
    const Nanoseconds commanded = schedule_.next_choosing();
    tick_clock_.begin_tick(schedule_.next_chosen(commanded), commanded);
    session_->tick(next_tick_);
    tick_clock_.begin_tick(Nanoseconds{0}, Nanoseconds{0});
    free_ = next_tick_ + commanded + Nanoseconds{1};
    if (local_ && next_tick_ >= next_build_) build_scene();
  }
}

void ClosedLoop::build_scene() { next_build_ = next_tick_ + time_of_building(local_->builder().work()); }

void ClosedLoop::plan_next_tick() {
  next_tick_ = schedule_.next_wake(free_);
  for (const Fault& fault : settings_.faults) {
    const bool stalled = fault.kind == Fault::Kind::stall && next_tick_ >= fault.at;
    if (stalled) next_tick_ = std::max(next_tick_, fault.at + fault.length);
  }
  free_ = next_tick_;
}

void ClosedLoop::apply_faults() {
  using Kind = Fault::Kind;
  bool up = false;
  bool down = false;
  bool killed = false;
  for (const Fault& fault : settings_.faults) {
    if (next_tick_ < fault.at || next_tick_ >= fault.at + fault.length) continue;
    up = up || fault.kind == Kind::blackout_up || fault.kind == Kind::blackout;
    down = down || fault.kind == Kind::blackout_down || fault.kind == Kind::blackout;
    killed = killed || fault.kind == Kind::server_killed;
  }
  if (!settings_.faults.empty()) {
    network_.set_blackhole(Direction::up, up);
    network_.set_blackhole(Direction::down, down);
    if (killed && server_) kill_server();
    if (!killed && !server_) start_server();
  }
}

Truth ClosedLoop::truth() const {
  const device::SimulatedDevice::Truth device = device_.truth();
  return {.time = clock_.now(),
          .velocity = device.velocity,
          .turning = device.turning,
          .ledger_J = session_->law().energy_J()};
}

const record::Summary& ClosedLoop::close() {
  bool closed = false;
  const Nanoseconds period = time::from_seconds(settings_.device.facts.period_s);
  for (const Nanoseconds end = next_tick_ + kClosing; !closed && next_tick_ < end; next_tick_ += period) {
    live_until(next_tick_);
    closed = session_->close(next_tick_);
  }
  summary_.finish(session_->totals());
  return summary_;
}

}  // namespace forcebound::sim
