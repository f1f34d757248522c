#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/session/session.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/server/session/server.hpp"
#include "tests/tools/sim/simulated_network.hpp"
#include "tests/tools/sim/virtual_clock.hpp"

namespace forcebound::sim {

/// Several clients, each behind a network of its own, and one server with a scene that they share; in virtual time:
///
///     hand -- device -- client ==( network )==+
///     hand -- device -- client ==( network )==+== server -- shared scene
///
/// All tick at the same times, and nothing takes time but the networks and building what is handed over. Everything
/// follows from the settings: same settings, same run.
class SharedLoop {
 public:
  struct Person {
    device::DeviceDescription device;
    std::function<std::unique_ptr<const device::Operator>()> make_hand;
    SimulatedNetworkSettings network{};
    bool renders_locally = false;
    record::TickSink* sink = nullptr;  ///< sees every tick; must outlive the loop
  };

  struct Settings {
    std::shared_ptr<const scene::Scene> scene;  ///< shared, for at least as many clients
    std::string law;
    std::vector<Person> people;
    std::uint64_t seed = 1;
  };

  /// @throws what device, operator, law and scene refuse
  explicit SharedLoop(const Settings& settings);
  ~SharedLoop();
  SharedLoop(const SharedLoop&) = delete;
  SharedLoop& operator=(const SharedLoop&) = delete;

  void run(Nanoseconds duration);

  /// The beginning of the last tick.
  [[nodiscard]] Nanoseconds time() const noexcept { return clock_.now(); }

  [[nodiscard]] const device::SimulatedDevice& device(std::size_t person) const;
  [[nodiscard]] const client::Session& session(std::size_t person) const;
  [[nodiscard]] SimulatedNetwork& network(std::size_t person);

 private:
  class Place;
  class ServerLink;

  void live_until(Nanoseconds time);

  VirtualClock clock_;
  std::vector<std::unique_ptr<Place>> places_;
  std::unique_ptr<ServerLink> link_;
  std::unique_ptr<server::Server> server_;
  Nanoseconds next_tick_{0};
  Nanoseconds next_timer_{0};
};

}  // namespace forcebound::sim
