#include "tests/sim/closed_loop.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "forcebound/client/device/make_operator.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/scene/explain.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kServerTimer = 250ms;
constexpr Nanoseconds kClosing = 30s;  // virtual, so patience costs nothing

}  // namespace

ClosedLoop::ClosedLoop(Settings settings, const std::vector<record::TickSink*>& sinks)
    : settings_(std::move(settings)),
      network_(clock_, settings_.network),
      device_(settings_.device, client::make_operator(settings_.hand, settings_.device.facts.degrees_of_freedom())),
      summary_(info()),
      sinks_(sinks),
      period_(time::from_seconds(settings_.device.facts.period_s)) {
  sinks_.push_back(&summary_);
  network_.set_server_handler([this](std::span<const std::byte> datagram, const Address& from, Nanoseconds now) {
    if (server_) server_->on_datagram(datagram, from, now);
  });
  start_server();
  session_ = std::make_unique<client::Session>(
      client::Session::Options{.server = network_.server_address(), .policy = settings_.policy, .seed = settings_.seed},
      device_, control::shipped_laws().make(settings_.law, device_.facts()), network_.add_client(), clock_,
      client::Session::Sinks{.ticks = sinks_});
}

ClosedLoop::~ClosedLoop() = default;

record::RunInfo ClosedLoop::info() const {
  record::RunInfo info;
  info.program = "virtual time";
  info.law = settings_.law;
  info.device = settings_.device.facts.name;
  info.facts = describe(settings_.device);
  info.operator_name = settings_.hand;
  info.hand = device_.hand().description();
  info.scene = settings_.scene->facts().name;
  info.simulated = server::summary(*settings_.scene);
  info.seed = settings_.seed;
  info.period = time::from_seconds(settings_.device.facts.period_s);
  info.hold = settings_.policy.hold;
  info.drop = settings_.policy.drop;
  info.force_N_max = settings_.device.facts.force_N_max;
  info.settle_s = settings_.settle_s;
  return info;
}

void ClosedLoop::start_server() {
  server::SceneLibrary scenes;
  scenes.add(settings_.scene);
  server_ = std::make_unique<server::Server>(
      server::ServerOptions{.scene = settings_.scene->facts().name}, std::move(scenes), network_.server_link(), clock_,
      [random = std::mt19937_64(settings_.seed + ++server_starts_)]() mutable { return random() | 1U; });
  network_.attach_server();
}

void ClosedLoop::kill_server() {
  network_.detach_server();
  server_.reset();
}

void ClosedLoop::live_until(Nanoseconds time) {
  // The server reads the clock too: let it show when each datagram comes.
  for (auto next = network_.next_event(); next && *next <= time; next = network_.next_event()) {
    clock_.set(std::max(*next, clock_.now()));
    network_.deliver_due(clock_.now());
  }
  clock_.set(time);
}

void ClosedLoop::run(Nanoseconds duration) {
  for (const Nanoseconds end = next_tick_ + duration; next_tick_ < end; next_tick_ += period_) {
    live_until(next_tick_);
    if (server_ && next_tick_ % kServerTimer == 0ns) server_->on_timer(next_tick_);
    session_->tick(next_tick_);
  }
}

const record::Summary& ClosedLoop::close() {
  bool closed = false;
  for (const Nanoseconds end = next_tick_ + kClosing; !closed && next_tick_ < end; next_tick_ += period_) {
    live_until(next_tick_);
    closed = session_->close(next_tick_);
  }
  summary_.finish(session_->totals());
  return summary_;
}

}  // namespace forcebound::sim
