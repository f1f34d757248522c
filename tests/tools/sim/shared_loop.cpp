#include "tests/tools/sim/shared_loop.hpp"

#include <algorithm>
#include <random>
#include <span>
#include <utility>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/environment/scene_environment.hpp"
#include "tests/tools/sim/building_time.hpp"

namespace forcebound::sim {
namespace {

constexpr Nanoseconds kTickPeriod = std::chrono::milliseconds{1};
constexpr Nanoseconds kTimerPeriod = std::chrono::milliseconds{250};

}  // namespace

/// One person with device, client and network.
class SharedLoop::Place {
 public:
  /// @param number of the person: the client's address differs from those of the others
  Place(const time::Clock& clock, const Person& person, std::size_t number)
      : network(clock, person.network), device(person.device, person.make_hand()), sinks_{person.sink} {
    for (std::size_t other = 0; other < number; ++other) (void)network.add_client();
    link_ = &network.add_client();
    address = network.client_address(number);
    if (person.renders_locally) {
      local.emplace(client::SceneBuilder::Options{
          .degrees_of_freedom = static_cast<std::uint32_t>(person.device.facts.translations()),
          .limits = handover::Limits::of_period(person.device.facts.period_s)});
    }
  }

  void begin_session(const time::Clock& clock, const std::string& law, std::uint64_t seed) {
    const auto used = std::span(sinks_).first(sinks_.front() == nullptr ? 0 : 1);
    session = std::make_unique<client::Session>(
        client::Session::Options{.server = network.server_address(), .seed = seed, .local = local ? &*local : nullptr},
        device, baselines::shipped_laws().make(law, device.facts(), {}), *link_, clock,
        client::Session::Sinks{.ticks = used});
  }

  SimulatedNetwork network;
  device::SimulatedDevice device;
  std::optional<client::LocalRendering> local{};
  std::unique_ptr<client::Session> session{};
  net::Address address{};
  Nanoseconds next_build{0};

 private:
  net::DatagramLink* link_ = nullptr;
  std::array<record::TickSink*, 1> sinks_;
};

/// The server's end of all networks.
class SharedLoop::ServerLink final : public net::DatagramLink {
 public:
  explicit ServerLink(const std::vector<std::unique_ptr<Place>>& places) : places_(places) {}

  bool send(std::span<const std::byte> datagram, const Address& to) noexcept override {
    const auto place = std::ranges::find_if(places_, [&](const auto& one) { return one->address == to; });
    return place != places_.end() && (*place)->network.server_link().send(datagram, to);
  }

  /// What arrives is handed to the server as it does.
  std::optional<net::Received> receive(std::span<std::byte>) noexcept override { return std::nullopt; }

 private:
  const std::vector<std::unique_ptr<Place>>& places_;
};

SharedLoop::SharedLoop(const Settings& settings) {
  for (const Person& person : settings.people)
    places_.push_back(std::make_unique<Place>(clock_, person, places_.size()));
  link_ = std::make_unique<ServerLink>(places_);
  server::EnvironmentLibrary environments;
  environments.add(server::scene_environment(settings.scene));
  server_ = std::make_unique<server::Server>(
      server::ServerOptions{.scene = settings.scene->facts().name}, std::move(environments), *link_, clock_,
      [random = std::mt19937_64(settings.seed)]() mutable { return random() | 1U; });
  for (std::size_t i = 0; i < places_.size(); ++i) {
    Place& place = *places_[i];
    place.network.set_server_handler([this](std::span<const std::byte> datagram, const Address& from, Nanoseconds now) {
      server_->on_datagram(datagram, from, now);
    });
    place.begin_session(clock_, settings.law, settings.seed + i);
  }
}

SharedLoop::~SharedLoop() = default;

const device::SimulatedDevice& SharedLoop::device(std::size_t person) const { return places_.at(person)->device; }

const client::Session& SharedLoop::session(std::size_t person) const { return *places_.at(person)->session; }

SimulatedNetwork& SharedLoop::network(std::size_t person) { return places_.at(person)->network; }

void SharedLoop::live_until(Nanoseconds time) {
  const auto next_of = [](const auto& place) { return place->network.next_event().value_or(Nanoseconds::max()); };
  while (true) {
    const auto next = std::ranges::min_element(places_, {}, next_of);
    if (next == places_.end() || next_of(*next) > time) break;
    // The server reads the clock too.
    clock_.set(std::max(next_of(*next), clock_.now()));
    (*next)->network.deliver_due(clock_.now());
  }
  clock_.set(time);
}

void SharedLoop::run(Nanoseconds duration) {
  for (const Nanoseconds end = next_tick_ + duration; next_tick_ < end; next_tick_ += kTickPeriod) {
    live_until(next_tick_);
    if (next_tick_ >= next_timer_) {
      server_->on_timer(next_tick_);
      next_timer_ += kTimerPeriod;
    }
    for (const auto& place : places_) {
      place->session->tick(next_tick_);
      if (!place->local || next_tick_ < place->next_build) continue;
      place->next_build = next_tick_ + time_of_building(place->local->builder().work());
    }
  }
}

}  // namespace forcebound::sim
