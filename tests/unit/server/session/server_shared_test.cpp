#include "forcebound/server/environment/body_models.hpp"
#include "tests/support/frail_model.hpp"
#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A shared scene for two clients: a ball without gravity.
class SharedSceneTest : public ServerFixture {
 protected:
  void SetUp() override {
    if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
    serve(
        parse_scene("[scene]\nname = \"ball\"\ndescription = \"\"\ndegrees_of_freedom = 3\n"
                    "shared = true\nclients_max = 2\n"
                    "[bodies]\ngravity_m_per_s2 = [0, 0, 0]\n"
                    "[[body]]\nname = \"ball\"\nmass_kg = 0.1\n"
                    "shape = { kind = \"sphere\", center_m = [0, 0, 0], radius_m = 0.02 }\n",
                    "ball.toml"));
  }

  void serve(const std::shared_ptr<const scene::Scene>& scene) {
    SceneLibrary scenes;
    scenes.add(scene);
    ServerOptions options;
    options.scene = scene->facts().name;
    start(options, std::move(scenes));
  }

  static wire::Hello hello_of(std::uint64_t nonce) {
    return {.client_nonce = nonce, .degrees_of_freedom = 3, .device = "omni", .period_s = 1e-3};
  }

  std::uint64_t enter(std::uint16_t who) {
    arrive(hello_of(who), address(who));
    return only_answer<wire::Welcome>().session;
  }

  double force_N(std::uint64_t session, std::uint64_t sequence, double x_m, std::uint16_t who) {
    arrive(wire::MotionSample{.session = session,
                              .sequence = sequence,
                              .device_time = milliseconds{sequence},
                              .position = vector_of({x_m, 0, 0})},
           address(who));
    return only_answer<wire::EnvironmentForce>().answer.force[0];
  }

  /// The left hand pushes the ball against the right one, which rests; the force on the right one at the end.
  double push(std::uint64_t left, std::uint64_t right) {
    double felt_N = 0;
    for (std::uint64_t i = 1; i <= 300; ++i) {
      clock.time += milliseconds{1};
      (void)force_N(left, i, -0.04 + std::min(1e-4 * static_cast<double>(i), 0.025), 1);
      felt_N = force_N(right, i, 0.023, 2);
    }
    return felt_N;
  }
};

TEST_F(SharedSceneTest, OneClientFeelsWhatTheOtherPushes) {
  const auto left = enter(1);
  const auto right = enter(2);
  EXPECT_GT(push(left, right), 0.05);
}

TEST_F(SharedSceneTest, APlaceIsLostToWhoAsksForItByADeviceThatStaysWhereItIsForAMinute) {
  const auto left = enter(1);
  const auto right = enter(2);
  auto for_50_s = [&, i = std::uint64_t{0}](double right_x_m) mutable {
    for (const auto end = clock.time + seconds{50}; clock.time < end; clock.time += milliseconds{100}) {
      ++i;
      (void)force_N(left, i, -0.04 + (i % 2 == 0 ? 4e-4 : 0), 1);
      (void)force_N(right, i, right_x_m, 2);
    }
  };
  for_50_s(0.04);
  arrive(hello_of(3), address(3));
  EXPECT_EQ(only_answer<wire::Refusal>().reason, wire::RefusalReason::server_full) << "it may go on in a moment";
  for_50_s(0.042);
  arrive(hello_of(3), address(3));
  const auto replies = answers();
  ASSERT_EQ(replies.size(), 2U);
  EXPECT_EQ(std::get<wire::Bye>(replies[0]).session, left) << "an encoder's steps are no motion";
  EXPECT_TRUE(std::holds_alternative<wire::Welcome>(replies[1]));
  EXPECT_EQ(server->counters().sessions_still, 1U);
  EXPECT_EQ(server->counters().sessions_idle, 0U);
}

TEST_F(SharedSceneTest, APlaceIsLostToWhoAsksForItOnceNobodyMovesThere) {
  const auto left = enter(1);
  const auto right = enter(2);
  (void)force_N(left, 1, -0.04, 1);
  (void)force_N(right, 1, 0.04, 2);
  clock.time += seconds{15};
  (void)force_N(right, 2, 0.04, 2);
  arrive(hello_of(3), address(3));
  EXPECT_EQ(only_answer<wire::Refusal>().reason, wire::RefusalReason::server_full);
  clock.time += seconds{10};
  arrive(hello_of(3), address(3));
  const auto answered = answers();
  ASSERT_EQ(answered.size(), 2u);
  EXPECT_EQ(std::get<wire::Bye>(answered[0]).session, left) << "it was silent for longest";
  EXPECT_NE(std::get<wire::Welcome>(answered[1]).session, 0u);
  (void)force_N(right, 3, 0.04, 2);
}

TEST_F(SharedSceneTest, TellsAClientThatRendersLocallyWhichReadingItsModelBelongsTo) {
  auto hello = hello_of(1);
  hello.renders_locally = true;
  arrive(hello, address(1));
  const auto session = only_answer<wire::Welcome>().session;
  local_model::LocalModel told;
  for (std::uint64_t i = 1; i <= 1000; ++i) {
    clock.time += milliseconds{1};
    arrive(
        wire::MotionSample{
            .session = session, .sequence = i, .device_time = milliseconds{i}, .position = vector_of({-0.04, 0, 0})},
        address(1));
    told = only_answer<wire::EnvironmentForce>().answer.model;
  }
  EXPECT_TRUE(told.has_mass);
  EXPECT_TRUE(told.mass.others_move_it);
  EXPECT_TRUE(told.by_device_clock);
  EXPECT_EQ(told.before_reading, milliseconds{2}) << "a period until the next motion comes, and a margin";
}

TEST_F(SharedSceneTest, RefusesClientsBeyondTheMaximumUntilOneLeaves) {
  const auto left = enter(1);
  const auto right = enter(2);
  (void)push(left, right);
  arrive(hello_of(3), address(3));
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.reason, wire::RefusalReason::server_full);
  EXPECT_THAT(std::string(refusal.text), HasSubstr("all 2 places in the shared scene 'ball' are taken"));
  arrive(wire::Bye{.session = left}, address(1));
  (void)answers();
  EXPECT_NE(enter(3), 0U);
}

TEST_F(SharedSceneTest, EvictsAClientThatNeverSentMotion) {
  (void)enter(1);
  (void)enter(2);
  clock.time += seconds{2};
  EXPECT_NE(enter(3), 0U);
  EXPECT_THAT(diary.lines,
              ElementsAre("opened omni in ball", "opened omni in ball", "closed omni: idle", "opened omni in ball"));
}

TEST_F(SharedSceneTest, BeginsAnewWhenAllHaveLeft) {
  const auto left = enter(1);
  const auto right = enter(2);
  (void)push(left, right);
  arrive(wire::Bye{.session = left}, address(1));
  arrive(wire::Bye{.session = right}, address(2));
  (void)answers();
  // The ball is where it was at first: a hand at 23 mm does not touch it.
  const auto again = enter(3);
  EXPECT_NEAR(force_N(again, 1, 0.0245, 3), 0, 1e-9);
}

TEST_F(SharedSceneTest, AClientThatJoinsAfterAQuarantineGetsANewDynamicModel) {
  serve(test::frail_scene(
      {.name = "frail", .description = "", .degrees_of_freedom = 3, .shared = true, .clients_max = 3}, {"jelly"}));
  const auto first = enter(1);
  const auto second = enter(2);
  const auto force_z_N = [&](std::uint64_t session, std::uint64_t sequence, std::uint16_t who) {
    clock.time += milliseconds{1};
    arrive(wire::MotionSample{.session = session, .sequence = sequence, .position = vector_of({0, 0, 0})},
           address(who));
    return only_answer<wire::EnvironmentForce>().answer.force[2];
  };
  EXPECT_EQ(force_z_N(first, 1, 1), 1);
  for (std::uint64_t i = 2; i < 6; ++i) (void)force_z_N(first, i, 1);
  EXPECT_EQ(force_z_N(first, 6, 1), 0);
  EXPECT_EQ(force_z_N(second, 1, 2), 0) << "who shares it feels nothing of it either";
  EXPECT_EQ(server->counters().objects_quarantined, 2U);
  EXPECT_EQ(diary.left_out, "jelly");
  EXPECT_EQ(diary.times_left_out, 2);
  EXPECT_EQ(force_z_N(enter(3), 1, 3), 1);
}

}  // namespace
}  // namespace forcebound::server
