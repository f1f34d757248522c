#include <gmock/gmock.h>

#include <csignal>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/process/leader.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Words kArm{"--follower", "reach-7", "--task", "stiff-wall"};

TEST(ARobot, FollowsItsLeaderAndBothSidesArePassive) {
  const RecordedHand hand;
  Server server(kArm);
  Client client(server.address(), and_also(hand.options(), {"--duration", "7", "--once"}));
  EXPECT_EQ(client.wait(), 0);
  EXPECT_TRUE(has_in_order(
      client.err(), {"robot reach-7 at stiff-wall", "the robot waits: keep the device still", "the robot follows"}));
  const nlohmann::json summary = client.summary();
  EXPECT_GT(summary["follower"]["seconds"]["following"], 0);
  if (was_led_all_the_time(server)) {
    EXPECT_GT(summary["force_N"]["max"], 1) << "the wall is felt";
  }
  EXPECT_EQ(summary["verdict"], "passive");
  EXPECT_GE(summary["passivity"]["minimum_J"], kPassiveLeast_J);

  EXPECT_EQ(server.stop(), 0);
  EXPECT_TRUE(has_in_order(server.err(), {"task 'stiff-wall'", "waiting -> following", "-> stopping",
                                          "the leader has left", "stopping -> stopped"}));
  const std::string totals = unwrapped(server.out());
  EXPECT_THAT(totals, AllOf(HasSubstr("robot: reach-7 at stiff-wall, position-force, law fba-exact"),
                            HasSubstr("at the end at rest"), HasSubstr("idle timer: "), Not(HasSubstr("allocation"))));
  const auto least_mJ = least_port_millijoules(totals);
  ASSERT_TRUE(least_mJ) << totals;
  EXPECT_GE(*least_mJ, kPassiveLeast_mJ);
}

TEST(ARobot, LearnsItsSensorsBiasWhenItIsTold) {
  Server server(kArm);
  ASSERT_TRUE(server.wait_for("listening on"));
  server.signal(SIGUSR1);
  EXPECT_TRUE(server.wait_for("robot: its sensor's bias is learned again")) << server.err();
  EXPECT_EQ(server.stop(), 0);
}

TEST(ARobot, HoldsAndStopsWhenItsLeaderIsKilledAndFollowsTheNext) {
  const RecordedHand hand;
  Server server(kArm);
  {
    Client killed(server.address(), hand.options());
    ASSERT_TRUE(killed.wait_for("the robot follows"));
    killed.signal(SIGKILL);
    ASSERT_TRUE(killed.wait());
  }
  ASSERT_TRUE(server.wait_for("stopping -> stopped"));
  // It holds first, unless the machine gave its loop no time until the leader had been silent for too long.
  EXPECT_TRUE(has_in_order(server.err(),
                           {"waiting -> following", "-> stopping", "the leader is silent", "stopping -> stopped"}));
  // The one that was killed has said no goodbye, so its session is still open.
  Client next(server.address(), hand.options());
  EXPECT_TRUE(next.wait_for("the robot has stopped: keep the device still"));
  EXPECT_TRUE(next.wait_for("the robot follows"));
  EXPECT_EQ(next.stop(), next.expected_end());
  EXPECT_EQ(server.stop(), 0);
}

TEST(ALeader, FadesItsForceWhenTheServerIsKilled) {
  const RecordedHand hand;
  Server server(kArm);
  Client client(server.address(), hand.options());
  ASSERT_TRUE(client.wait_for("the robot follows"));
  server.signal(SIGKILL);
  ASSERT_TRUE(client.wait_for("old: zero force"));
  EXPECT_TRUE(has_in_order(client.err(), {"the robot follows", "old: fading", "old: zero force"}));
  EXPECT_EQ(client.stop(), 0);
  EXPECT_GE(client.summary()["passivity"]["minimum_J"], kPassiveLeast_J);
}

TEST(ARobot, RefusesASecondLeaderNamingTheFirst) {
  const RecordedHand hand;
  Server server(kArm);
  Client first(server.address(), hand.options());
  ASSERT_TRUE(first.wait_for("the robot follows"));
  Client second(server.address(), {"--device", "omni", "--operator", "wave", "--once", "--duration", "10"});
  const std::optional<int> ended = second.wait();
  if (ended != 5 && !was_led_all_the_time(server))
    GTEST_SKIP() << "the machine is too slow: the first leader was silent";
  EXPECT_EQ(ended, 5);
  EXPECT_THAT(second.err(), HasSubstr("the robot is led by 'firm-3dof': it follows one leader at a time"));
  EXPECT_EQ(first.stop(), 0);
  EXPECT_THAT(first.err(), Not(HasSubstr("the robot refuses")));
}

TEST(ARobot, RefusesALeaderOfTooFewDegreesOfFreedom) {
  Server server({"--follower", "reach-7", "--task", "plug"});
  Client client(server.address(), {"--device", "wall-1dof", "--once"});
  EXPECT_EQ(client.wait(), 5);
  EXPECT_THAT(client.err(), HasSubstr("'plug' accepts devices with 3 degrees of freedom, device 'wall-1dof' has 1"));
}

TEST(ARobot, IsBroughtToRestBySigterm) {
  const RecordedHand hand;
  Server server(kArm);
  Client client(server.address(), hand.options());
  ASSERT_TRUE(client.wait_for("the robot follows"));
  EXPECT_EQ(server.stop(), 0);
  EXPECT_TRUE(has_in_order(server.err(), {"waiting -> following", "-> stopping", "stopping -> stopped"}));
  EXPECT_THAT(unwrapped(server.out()), HasSubstr("at the end at rest"));
  EXPECT_TRUE(client.wait_for("the server ended the session"));
}

TEST(ARobot, IsRefusedInALineWhereItCannotBe) {
  for (const auto& [words, said] : std::vector<std::pair<Words, std::string>>{
           {{"--follower", "reach7", "--task", "plug"}, "did you mean 'reach-7'"},
           {{"--follower", "reach-7", "--task", "plugs"}, "did you mean 'plug'"},
           {{"--follower", "reach-7", "--task", "plug", "--scene", "wall"}, "--scene"},
           {{"--follower", "reach-7", "--task", "plug", "--workers", "2"},
            "--workers must be 1 with --follower: a robot has one leader, got 2"},
           {{"--follower", "reach-7", "--task", "plug", "--follower-law", "nome"}, "did you mean 'none'"}}) {
    const Ran ran = run(kServer, words);
    EXPECT_EQ(ran.exit_code, 2) << said;
    EXPECT_THAT(ran.err, HasSubstr(said));
    EXPECT_LE(lines(ran.err), 2U) << ran.err;
  }
}

}  // namespace
}  // namespace forcebound::test
