#include "forcebound/client/rendering/local_rendering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stop_token>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

wire::SceneOffer offer_of(const handover::PackedScene& scene) {
  const handover::Announcement& a = scene.announcement();
  return {.manifest_sha256 = a.hash,
          .manifest_bytes = static_cast<std::uint32_t>(a.manifest_bytes),
          .pieces = static_cast<std::uint32_t>(a.pieces)};
}

/// The server's word on a device in the air.
std::optional<wire::EnvironmentForce> in_the_air(const Vector& position) {
  wire::EnvironmentForce force;
  force.session = 1;
  force.answer.force = Vector::Zero(position.rows());
  force.position = position;
  return force;
}

/// A client with the tick and its builder in one hand, about a ball of 30 mm.
class ALocalScene : public ::testing::Test {
 protected:
  void offer() {
    local.begin(1, offer_of(*scene));
    local.builder().work();
  }
  /// As the server sends them: what is nearest to the top first.
  void receive(std::size_t i) {
    local.receive({.session = 1,
                   .transmission = i + 1,
                   .number = static_cast<std::uint32_t>(nearest_first[i]),
                   .content = scene->piece(nearest_first[i])});
  }
  void deliver(std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      receive(i);
      if (i % 100 == 0) local.builder().work();
    }
    local.builder().work();
  }
  [[nodiscard]] std::optional<Answer> at(double z_m) {
    position[2] = z_m;
    return local.answer(position, time += 1ms, reply);
  }

  std::shared_ptr<const handover::PackedScene> scene = handover::pack(*handover::mesh_scene(test::ball(0.03, 40)));
  std::size_t pieces = scene->announcement().pieces;
  std::vector<std::size_t> nearest_first = [this] {
    const scene::Point top_m(0, 0, 0.03);
    std::vector<std::size_t> order(pieces);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {},
                             [&](std::size_t piece) { return scene->where_m(piece).squaredExteriorDistance(top_m); });
    return order;
  }();
  LocalRendering local{{.degrees_of_freedom = 3}};
  Vector position = scene::Point(1e-4, 0, 0.032);
  std::optional<wire::EnvironmentForce> reply = in_the_air(position);
  Nanoseconds time{0};
};

TEST_F(ALocalScene, AnswersNothingBeforeItIsThere) {
  EXPECT_FALSE(at(0.032));
  EXPECT_FALSE(local.receipt().wanted) << "before the cache was looked through";
  offer();
  EXPECT_TRUE(local.receipt().wanted);
  EXPECT_FALSE(at(0.032));
}

TEST_F(ALocalScene, WaitsForTheServersFirstWordOnWhereTheDeviceIs) {
  offer();
  deliver(0, pieces);
  reply.reset();
  EXPECT_FALSE(at(0.032));
  reply = in_the_air(position);
  EXPECT_TRUE(at(0.032));
}

TEST_F(ALocalScene, BeginsFromNoWordOfAnotherSessionNorOneOfLongAgo) {
  offer();
  deliver(0, pieces);
  reply->session = 7;
  EXPECT_FALSE(at(0.032)) << "it was outside of another scene";
  reply->session = 1;
  time = 1001ms;
  EXPECT_FALSE(at(0.032)) << "it may have come round anything since";
  reply->motion_device_time = 900ms;
  EXPECT_TRUE(at(0.032));
}

TEST_F(ALocalScene, IsNotBuiltForAClientThatEnds) {
  offer();
  std::stop_source end;
  end.request_stop();
  for (std::size_t i = 0; i < pieces; ++i) receive(i);
  EXPECT_EQ(local.builder().work(end.get_token()), 0U);
  EXPECT_EQ(local.builder().counts().scenes_built, 0U);
  EXPECT_EQ(local.builder().counts().refused, 0U) << "it was not the scene's fault";
  local.builder().work();
  EXPECT_EQ(local.builder().counts().scenes_built, 1U);
}

TEST_F(ALocalScene, PushesFromTheSideOnWhichTheServerSawTheDeviceThoughItIsWithinByNow) {
  offer();
  deliver(0, pieces);
  const auto answer = at(0.029);
  ASSERT_TRUE(answer);
  EXPECT_NEAR(answer->force.z(), 1.0, 0.02);
  EXPECT_NEAR(answer->contact_normal.z(), 1.0, 0.01);
}

TEST_F(ALocalScene, RunsACoarseLevelWhereOtherPiecesAreMissingAndTheServersAnswerIsLate) {
  scene = handover::pack(*handover::mesh_scene(test::ball(0.03, 60)));
  offer();
  std::uint64_t came = 0;
  for (std::uint32_t i = 0; i < scene->announcement().pieces; ++i) {
    if (!scene->comes_first(i)) continue;
    local.receive({.session = 1, .transmission = ++came, .number = i, .content = scene->piece(i)});
    local.builder().work();
  }
  EXPECT_LT(3 * came, scene->announcement().pieces);
  EXPECT_FALSE(at(0.029)) << "a fresh answer is nearer to the truth";
  time += LocalScene::kCoarseSince;
  const auto answer = at(0.029);
  ASSERT_TRUE(answer);
  EXPECT_NEAR(answer->force.z(), 1.0, 0.3);
  EXPECT_TRUE(local.receipt().wanted) << "the rest";
}

TEST_F(ALocalScene, AnswersNothingWhereATickWouldVisitTooMuchOfAMesh) {
  // From the middle of a ball, all of its triangles are equally near.
  const auto from_the_middle = in_the_air(scene::Point(0, 0, 0));
  offer();
  deliver(0, pieces);
  EXPECT_TRUE(local.answer(position, time += 1ms, from_the_middle));
  EXPECT_EQ(local.scene().searches_exhausted(), 0U);

  LocalRendering hurried{{.degrees_of_freedom = 3, .limits = handover::Limits::of_period(3e-5)}};
  hurried.begin(1, offer_of(*scene));
  hurried.builder().work();
  for (std::uint32_t i = 0; i < pieces; ++i) {
    hurried.receive({.session = 1, .transmission = i + 1, .number = i, .content = scene->piece(i)});
    hurried.builder().work();
  }
  ASSERT_EQ(hurried.phase(), BuildPhase::whole);
  EXPECT_FALSE(hurried.answer(position, time += 1ms, from_the_middle));
  EXPECT_EQ(hurried.scene().searches_exhausted(), 1U);
  EXPECT_TRUE(hurried.answer(position, time += 1ms, reply)) << "from above it, a few of them are near";
  EXPECT_EQ(hurried.scene().searches_exhausted(), 1U);
}

TEST_F(ALocalScene, GoesOnFromTheSurfaceThatTheServerSaysIsTouched) {
  offer();
  deliver(0, pieces);
  reply->position = scene::Point(1e-4, 0, 0.0285);
  reply->answer.contact_normal = scene::Point(0, 0, 1);
  reply->answer.penetration_m = 0.0016;
  const auto answer = at(0.0285);
  ASSERT_TRUE(answer);
  EXPECT_NEAR(answer->force.z(), 1.5, 0.05);
}

TEST_F(ALocalScene, AcknowledgesWhatCameAndWantsNoMoreOnceAllIsThere) {
  offer();
  deliver(0, 3);
  EXPECT_EQ(local.receipt(), (wire::PieceReceipt{.wanted = true, .newest = 3, .before = 3}));
  deliver(3, pieces);
  EXPECT_EQ(local.phase(), BuildPhase::whole);
  EXPECT_EQ(local.receipt(), wire::PieceReceipt{});
}

TEST_F(ALocalScene, AcknowledgesNoPieceForWhichThereWasNoRoom) {
  offer();
  for (std::uint64_t i = 1; i <= 2000; ++i)
    local.receive({.session = 1, .transmission = i, .number = 0, .content = scene->piece(0)});
  EXPECT_LT(local.receipt().newest, 1000U);
}

TEST_F(ALocalScene, StaysThroughAnotherSessionOfTheSameSceneAndGoesWithTheServersBye) {
  offer();
  deliver(0, pieces);
  ASSERT_TRUE(at(0.032));
  local.begin(2, offer_of(*scene));
  EXPECT_TRUE(at(0.031));
  local.end();
  EXPECT_FALSE(at(0.031));
}

TEST_F(ALocalScene, MakesRoomForAnotherScene) {
  offer();
  deliver(0, pieces);
  ASSERT_TRUE(at(0.032));
  const auto other = handover::pack(*handover::mesh_scene(test::ball(0.01, 10)));
  local.begin(2, offer_of(*other));
  EXPECT_FALSE(at(0.029)) << "the scene of before is no more";
  local.builder().work();
  for (std::uint32_t i = 0; i < other->announcement().pieces; ++i) {
    local.receive({.session = 2, .transmission = i + 1, .number = i, .content = other->piece(i)});
    local.builder().work();
  }
  reply->session = 2;
  const auto answer = at(0.029);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->penetration_m, 0);
}

TEST_F(ALocalScene, DoesNotComeBackAfterItsEndWhileTheBuilderHasNoRoomToHearOfIt) {
  offer();
  deliver(0, pieces);  // built, and not taken yet
  for (std::size_t i = 0; i < 1000; ++i) receive(0);
  const auto other = handover::pack(*handover::mesh_scene(test::ball(0.01, 10)));
  local.begin(2, offer_of(*other));
  reply->session = 2;
  EXPECT_FALSE(at(0.032)) << "it is of the scene before";
  local.builder().work();
  EXPECT_FALSE(at(0.032));
}

TEST_F(ALocalScene, RunsNothingMoreOfASceneOfWhichAPieceIsWrong) {
  offer();
  deliver(0, pieces / 2);
  ASSERT_TRUE(at(0.032));
  const std::size_t last = nearest_first.back();
  std::vector<std::byte> wrong(scene->piece(last).begin(), scene->piece(last).end());
  wrong.back() ^= std::byte{1};
  local.receive({.session = 1, .transmission = pieces, .number = static_cast<std::uint32_t>(last), .content = wrong});
  local.builder().work();
  EXPECT_EQ(local.phase(), BuildPhase::refused);
  EXPECT_FALSE(at(0.032));
  EXPECT_FALSE(at(0.029));
}

TEST_F(ALocalScene, CountsPartsThatItLeavesOutBecauseTheirForceIsNotFinite) {
  scene = handover::pack(*handover::scene_of(R"(
[[object]]
name = 'plane'
shape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }
effects = ['surface']
[object.surface]
stiffness_N_per_m = 10000
)"));
  pieces = scene->announcement().pieces;
  nearest_first.resize(pieces);
  std::iota(nearest_first.begin(), nearest_first.end(), std::size_t{0});
  offer();
  deliver(0, pieces);
  ASSERT_TRUE(at(0.032));
  EXPECT_EQ(local.scene().quarantined(), 0U);
  const auto without = at(-1e305);
  ASSERT_TRUE(without);
  EXPECT_TRUE(without->force.isZero(0));
  EXPECT_EQ(local.scene().quarantined(), 1U);
  (void)at(-0.001);
  EXPECT_EQ(local.scene().quarantined(), 1U);
}

TEST_F(ALocalScene, AnswersSwapsAndForgetsWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  offer();
  deliver(0, pieces / 2);
  ASSERT_TRUE(at(0.032));
  for (std::size_t i = pieces / 2; i < pieces; ++i) {
    {
      const test::AllocationGuard tick;
      receive(i);
      (void)local.receipt();
      (void)at(0.0295 + 1e-3 * std::sin(0.1 * static_cast<double>(i)));
      EXPECT_EQ(tick.heap_operations(), 0U);
    }
    local.builder().work();
  }
  EXPECT_GE(local.builder().counts().scenes_built, 2U);
  const test::AllocationGuard tick;
  local.end();
  (void)at(0.03);
  local.begin(3, offer_of(*scene));
  (void)at(0.03);
  EXPECT_EQ(tick.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
