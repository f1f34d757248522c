#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::sim {

using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

/// A hand at the omni that traces the sphere, with the law that guarantees passivity on it.
inline ClosedLoop::Settings omni_on_the_sphere(const std::string& netem = "delay 5ms") {
  ClosedLoop::Settings settings;
  settings.device = device::load_device("omni");
  settings.hand = "trace-sphere";
  settings.law = "fba-exact";
  settings.scene = server::load_scene("sphere");
  settings.network.up = settings.network.down = netem::parse_netem(netem);
  return settings;
}

/// Invariants under any network, checked on every tick.
class NeverBroken final : public record::TickSink {
 public:
  explicit NeverBroken(double force_N_max) : most_N_(force_N_max) {}
  void on_tick(const record::TickRecord& tick) noexcept override {
    broken += !tick.applied.allFinite() || tick.applied.norm() > most_N_ * (1 + 1e-12) ||
              tick.audit_minimum_J < -1e-9 || tick.energy_J > tick.audit_J + 1e-9;
    pushed += !tick.applied.isZero(0);
  }

  std::uint64_t broken = 0;
  std::uint64_t pushed = 0;

 private:
  double most_N_;
};

/// A loop whose invariants hold to the end, and whose session is active at the end.
class NetworkHardCase : public testing::Test {
 protected:
  explicit NetworkHardCase(const ClosedLoop::Settings& settings = omni_on_the_sphere())
      : never(settings.device.facts.force_N_max), loop(settings, {&never}) {
    loop.run(2s);
    EXPECT_EQ(loop.session().state(), client::SessionState::active);
    EXPECT_GT(never.pushed, 100U) << "no force was applied";
  }

  void expect_unbroken_and_back() {
    loop.run(3s);
    EXPECT_EQ(loop.session().state(), client::SessionState::active);
    EXPECT_EQ(never.broken, 0U);
  }

  [[nodiscard]] std::uint64_t malformed() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : loop.totals().malformed) sum += count;
    return sum;
  }

  /// As if the server had sent it.
  void send_to_client(const Bytes& datagram) {
    ASSERT_TRUE(loop.network().server_link().send(datagram, loop.network().client_address(0)));
  }

  NeverBroken never;
  ClosedLoop loop;
  wire::Codec codec;
};

inline Bytes bytes_of(std::span<const std::byte> datagram) { return {datagram.begin(), datagram.end()}; }

}  // namespace forcebound::sim
