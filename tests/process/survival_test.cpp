#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <list>
#include <optional>
#include <thread>

#include "tests/process/recorded_run.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using record::ForcePolicy;
using record::TickRecord;
using testing::HasSubstr;
using Nanoseconds = time::Nanoseconds;

/// Hands in contact with a sphere and with a wall, with one law each, on one server: under ThreadSanitizer two clients
/// take one of two processors.
class HandsInContact : public testing::Test {
 protected:
  HandsInContact() {
    server.emplace(Words{});
    address = server->address();
    const std::vector<std::string> laws = shipped_among({"fba-exact", "fba-more"});
    clients.emplace_back(
        address, Words{"--scene", "sphere", "--device", "omni", "--operator", "trace-sphere", "--law", laws.front()});
    clients.emplace_back(
        address, Words{"--scene", "wall", "--device", "wall-1dof", "--operator", "press", "--law", laws.back()});
    for (const RecordedClient& client : clients) EXPECT_TRUE(client.wait_for_tick(is_pressed));
  }

  void signal_all(int number) {
    for (const RecordedClient& client : clients) client.signal(number);
  }

  /// Ends all clients and checks each one's recording.
  template <class Look>
  void end_and_look(Look look) {
    for (RecordedClient& client : clients) {
      const std::optional<int> ended = client.stop();
      EXPECT_EQ(ended, client.expected_end());
      const RecordedRun run = client.run();
      SCOPED_TRACE(run.info.device + " with law " + run.info.law);
      expect_late_force_policy(run);
      expect_passive(run);
      look(client, run);
    }
  }

  std::optional<Server> server;
  std::string address;
  std::list<RecordedClient> clients;
};

/// The first tick at or after `since` of which `condition` holds.
template <class Condition>
const TickRecord* first_tick(const RecordedRun& run, Nanoseconds since, Condition condition) {
  const auto found = std::find_if(run.ticks.begin(), run.ticks.end(),
                                  [&](const TickRecord& tick) { return tick.time >= since && condition(tick); });
  return found == run.ticks.end() ? nullptr : &*found;
}

const TickRecord* first_tick(const RecordedRun& run, Nanoseconds since, ForcePolicy policy) {
  return first_tick(run, since, [&](const TickRecord& tick) { return tick.policy == policy; });
}

auto is_fresh_after(Nanoseconds time) {
  return [time](const TickRecord& tick) { return tick.time > time && tick.policy == ForcePolicy::fresh; };
}

TEST_F(HandsInContact, FeelTheForceOfAKilledServerFadeAndThenTheNextServer) {
  const Nanoseconds killed = steady_now();
  server->stop(SIGKILL);
  for (RecordedClient& client : clients) EXPECT_TRUE(client.wait_for(": zero force"));
  const Nanoseconds restarted = steady_now();
  // Waits until it listens. A client may have its first force before this returns.
  server.emplace(Words{}, address);
  for (const RecordedClient& client : clients) EXPECT_TRUE(client.wait_for_tick(is_fresh_after(restarted)));

  end_and_look([&](const RecordedClient& client, const RecordedRun& run) {
    const TickRecord* const pressing = first_tick(run, run.ticks.front().time, is_pressed);
    const TickRecord* const fading = first_tick(run, killed, ForcePolicy::fading);
    const TickRecord* const dropped = first_tick(run, killed, ForcePolicy::dropped);
    ASSERT_TRUE(pressing && fading && dropped);
    EXPECT_LT(pressing->time, fading->time) << "in contact";
    // The exact ages are checked above, on every tick.
    EXPECT_LT(fading->time, dropped->time);
    const TickRecord* const fresh = first_tick(run, dropped->time, ForcePolicy::fresh);
    ASSERT_NE(fresh, nullptr);
    EXPECT_GT(fresh->time, restarted);
    EXPECT_EQ(fresh->state, record::SessionState::active);

    const nlohmann::json summary = client.summary();
    EXPECT_EQ(summary["faults"]["reconnects"], 1);
    EXPECT_GT(summary["late_force"]["fading_ticks"], 0);
    EXPECT_GT(summary["late_force"]["dropped_ticks"], 0);
    EXPECT_GT(summary["faults"]["port_unreachable"], 0);
    EXPECT_EQ(summary["blackouts"]["longest"]["died"], "unknown");
    EXPECT_THAT(unwrapped(client.out()),
                HasSubstr("then in another session: the server had restarted or closed this one"));
    EXPECT_THAT(unwrapped(client.err()), HasSubstr("zero force"));
    EXPECT_THAT(unwrapped(client.err()), HasSubstr("forces are fresh again"));
  });
}

/// sqrt(4 E_n b / T): what the published laws allow on one axis.
double published_bound_N(const TickRecord& tick, double damping_N_s_per_m, double period_s) {
  return std::sqrt(4 * std::max(0.0, tick.energy_J) * damping_N_s_per_m / period_s);
}

TEST_F(HandsInContact, FeelNoJumpWhenTheirStoppedClientsRunAgain) {
  signal_all(SIGSTOP);
  std::this_thread::sleep_for(2s);
  signal_all(SIGCONT);
  const Nanoseconds resumed_by_now = steady_now();
  for (const RecordedClient& client : clients) EXPECT_TRUE(client.wait_for_tick(is_fresh_after(resumed_by_now)));

  end_and_look([&](const RecordedClient& client, const RecordedRun& run) {
    const TickRecord* const resumed =
        first_tick(run, run.ticks.front().time, [](const TickRecord& tick) { return tick.interval > 1900ms; });
    ASSERT_NE(resumed, nullptr);
    ASSERT_GT(resumed->tick, 1U);
    const TickRecord* const pressing = first_tick(run, run.ticks.front().time, is_pressed);
    ASSERT_NE(pressing, nullptr);
    EXPECT_LT(pressing->time, resumed->time) << "in contact";
    // Forces received meanwhile are two seconds old; but a fast server may have answered the motion sent just now.
    if (resumed->force_sequence < resumed->motion_sequence) {
      EXPECT_EQ(resumed->policy, ForcePolicy::dropped);
      EXPECT_TRUE(resumed->applied.isZero(0));
    }
    if (run.info.device == "wall-1dof" && run.info.law != "fba-exact") {
      for (const TickRecord* tick = resumed; tick <= &run.ticks.back(); ++tick) {
        ASSERT_LE(tick->applied.norm(), published_bound_N(*tick, 30, 1e-3) * (1 + 1e-9)) << "tick " << tick->tick;
      }
    }
    const TickRecord* const fresh = first_tick(run, resumed->time, ForcePolicy::fresh);
    ASSERT_NE(fresh, nullptr);

    const nlohmann::json summary = client.summary();
    EXPECT_GE(summary["faults"]["released_by_device"], 1);
    EXPECT_EQ(summary["faults"]["reconnects"], 0);
    EXPECT_EQ(summary["faults"]["tick_allocations"], 0);
    // The missed ticks are left out, not made up for.
    EXPECT_GE(summary["faults"]["missed_ticks"], 1900);
    EXPECT_GE(summary["period_us"]["max"].get<double>(), 1.9e6);
    EXPECT_LE(summary["ticks"].get<double>(), 1000 * summary["duration_s"].get<double>() - 1800);
    EXPECT_EQ(summary["blackouts"]["longest"]["died"], "neither");
  });
}

}  // namespace
}  // namespace forcebound::test
