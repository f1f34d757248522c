#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/counting_law.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

ClosedLoop::Settings with_counting(test::CountLog& log, const std::string& netem) {
  const auto parameters = netem::parse_netem(netem);
  return {.device = device::load_device("wall-1dof"),
          .hand = "press",
          .law = "counting",
          .scene = server::load_scene("wall"),
          .network = {.up = parameters, .down = parameters, .trace = {}, .seed = 5},
          .laws = std::make_shared<const control::LawRegistry>(test::laws_with_counting(log))};
}

bool rises(const std::vector<double>& numbers) { return std::ranges::is_sorted(numbers, std::less_equal<>()); }

//   law at the device ==( late, lost, doubled, reordered )== server-side law
TEST(ServerSideLaw, ExchangesNumbersBothWaysAndNeverOldOnesAfterNewOnes) {
  test::CountLog log;
  ClosedLoop loop(with_counting(log, "delay 5ms 3ms loss 10% duplicate 10%"));
  loop.run(5s);
  EXPECT_GT(log.ticks_received.size(), 2000U);
  EXPECT_GT(log.answers_received.size(), 1500U);
  EXPECT_GT(loop.totals().reordered, 100U);
  EXPECT_GT(loop.totals().duplicated, 100U);
  for (const auto* heard : {&log.ticks_received, &log.answers_received, &log.ticks_confirmed})
    EXPECT_TRUE(rises(*heard));
  const std::set<double> received(log.ticks_received.begin(), log.ticks_received.end());
  EXPECT_TRUE(std::ranges::all_of(log.ticks_confirmed, [&](double ticks) { return received.contains(ticks); }));
  EXPECT_NEAR(log.ticks_confirmed.back(), 5000, 30) << "a round trip behind";
  double time_s = 0;
  for (const double interval_s : log.intervals_s) time_s += interval_s;
  EXPECT_NEAR(time_s, 5, 0.05) << "intervals span the motions that were lost";
}

TEST(ServerSideLaw, BeginsAnewWithTheServerThatRestarts) {
  test::CountLog log;
  ClosedLoop loop(with_counting(log, "delay 2ms loss 5%"));
  loop.run(2s);
  ASSERT_EQ(log.server_side_began.size(), 1U);
  ASSERT_GT(log.answers_received.back(), 1500);
  loop.kill_server();
  loop.run(100ms);
  loop.start_server();
  loop.run(1s);
  ASSERT_EQ(log.server_side_began.size(), 2U);
  const std::vector<double> since(
      log.answers_received.begin() + static_cast<std::ptrdiff_t>(log.server_side_began.back()),
      log.answers_received.end());
  ASSERT_GT(since.size(), 500U);
  EXPECT_LT(since.front(), 5);
  EXPECT_TRUE(rises(since));
  EXPECT_NEAR(log.ticks_received.back(), 3100, 10) << "the law at the device goes on counting";
}

}  // namespace
}  // namespace forcebound::sim
