// Sessions whose server tells local models.

#include <limits>
#include <memory>
#include <utility>

#include "forcebound/handover/packed_scene.hpp"
#include "forcebound/scene/part.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

struct HasLocalRendering {
  LocalRendering local{{.degrees_of_freedom = 1}};
};

/// A wall of 1 N/mm that fills what lies beyond x = 0.
std::shared_ptr<const handover::PackedScene> packed_wall() {
  const scene::PartDescription wall{
      .name = "wall",
      .shape =
          scene::NamedValues{"half_space", {{"through_m", scene::Point(0, 0, 0)}, {"normal", scene::Point(-1, 0, 0)}}},
      .effects = {{"surface", {{"stiffness_N_per_m", 1000.0}}}}};
  scene::SceneParts parts;
  parts.objects.push_back(scene::make_part(wall, scene::Registry::standard(), 1));
  return handover::pack(scene::Scene({.name = "wall", .description = "", .degrees_of_freedom = 1}, std::move(parts)));
}

/// A pad that is pressed along x, at 1 N/mm.
class SessionModels : private HasLocalRendering, public SessionTest {
 protected:
  SessionModels() : SessionTest("none", baselines::shipped_laws(), &local) {}

  /// The answer to the last motion, for a device that was 2 mm deep in the pad.
  wire::EnvironmentForce pressed() {
    const auto motion = sent<wire::MotionSample>().back();
    wire::EnvironmentForce force = answer(motion, -2);
    force.answer.model.by_device_clock = true;
    force.answer.model.surfaces[0] = {.id = 1,
                                      .force_N = {-2, 0, 0},
                                      .place_m = {motion.position[0] - 0.002, 0, 0},
                                      .normal = {-1, 0, 0},
                                      .stiffness_N_per_m = Eigen::Vector3d(1000, 0, 0).asDiagonal(),
                                      .radius_m = 0.05};
    force.answer.model.surface_count = 1;
    return force;
  }

  /// What has a thread of its own in a program.
  void build() { local.builder().work(); }

  void begin() {
    connect();
    device.position = Vector::Constant(1, 0.01);
    tick();
  }
};

TEST_F(SessionModels, AreRenderedWhereTheDeviceIsNow) {
  begin();
  arrive(pressed());
  tick();
  EXPECT_NEAR(device.applied[0], -2, 1e-6);
  device.position[0] = 0.011;
  tick();
  EXPECT_NEAR(device.applied[0], -3, 1e-6);
  EXPECT_EQ(records.last.rendering, record::ForceOrigin::at_client);
  EXPECT_NEAR(records.last.model[0], -3, 1e-6);
  EXPECT_EQ(records.last.remote[0], -2);
  device.position[0] = 0.007;
  tick();
  EXPECT_NEAR(device.applied[0], 0, 1e-6) << "it has left the pad";
}

TEST_F(SessionModels, OfAnEnvironmentThatKnowsItsDerivativeAreExtrapolated) {
  begin();
  const auto motion = sent<wire::MotionSample>().back();
  wire::EnvironmentForce force = answer(motion, -2);
  force.answer.model.by_device_clock = true;
  force.answer.model.has_field = true;
  force.answer.model.field.force_N = {-2, 0, 0};
  force.answer.model.field.place_m = {motion.position[0], 0, 0};
  force.answer.model.field.jacobian_N_per_m(0, 0) = -300;
  force.answer.model.field.radius_m = 0.02;
  arrive(force);
  tick();
  device.position[0] += 0.002;
  tick();
  EXPECT_NEAR(device.applied[0], -2.6, 1e-5);
  device.position[0] += 0.02;
  tick();
  EXPECT_NEAR(device.applied[0], -2, 1e-5) << "beyond its radius it is held";
}

// The pad comes towards the device at 0.1 m/s, by the server's clock, which shows the same as the device's.
TEST_F(SessionModels, OfWhatMovesByTheServersClockGoOnFromTheArrivalOfTheMotionThere) {
  begin();
  auto near = pressed();
  near.server_receive_time = near.server_send_time = clock.time;
  arrive(near);
  tick();
  (void)sent<wire::MotionSample>();
  tick();
  auto late = pressed();
  late.answer.model.by_device_clock = false;
  late.answer.model.surfaces[0].velocity_m_per_s = {-0.1, 0, 0};
  late.server_receive_time = late.server_send_time = clock.time + 15ms;
  for (int i = 0; i < 40; ++i) tick();
  arrive(late);
  tick();
  for (int i = 0; i < 60; ++i) tick();
  // 101 ms since the motion, of which it was on its way for 15 ms; the near answer says so to half a millisecond.
  EXPECT_NEAR(device.applied[0], -2 - 1000 * 0.1 * 0.086, 0.06);
}

// The pad comes towards the device at 0.1 m/s; the server has played the path until 20 ms before the reading answered.
TEST_F(SessionModels, OfAPathThatIsPlayedLaterGoOnFromTheReadingPlayed) {
  begin();
  auto played = pressed();
  played.answer.model.before_reading = 20ms;
  played.answer.model.surfaces[0].velocity_m_per_s = {-0.1, 0, 0};
  arrive(played);
  for (int i = 0; i < 50; ++i) tick();
  EXPECT_NEAR(device.applied[0], -2 - 1000 * 0.1 * 0.070, 0.06);
}

TEST_F(SessionModels, OfAPathThatIsPlayedLaterAreAsOldAsThatAlsoBeyondTheHoldTime) {
  begin();
  auto played = pressed();
  played.answer.model.before_reading = 200ms;
  played.answer.model.surfaces[0].velocity_m_per_s = {-0.05, 0, 0};
  arrive(played);
  for (int i = 0; i < 150; ++i) tick();
  EXPECT_NEAR(device.applied[0], -2 - 1000 * 0.05 * 0.350, 0.06);
}

TEST_F(SessionModels, AreCountedAndTheirForceIsHeldIfTheyAreUnsound) {
  begin();
  auto force = pressed();
  force.answer.model.surfaces[0].stiffness_N_per_m(0, 0) = std::numeric_limits<double>::quiet_NaN();
  arrive(force);
  tick();
  device.position[0] = 0.011;
  tick();
  EXPECT_EQ(device.applied[0], -2);
  EXPECT_EQ(records.last.rendering, record::ForceOrigin::held);
  EXPECT_EQ(records.last.model.rows(), 0);
  EXPECT_EQ(session.totals().models_refused, 1U);
}

TEST_F(SessionModels, FadeAsAHeldForceDoesWhenTheServerIsSilentIfTheyMove) {
  begin();
  auto force = pressed();
  // Along the surface, slower than what would be felt.
  force.answer.model.surfaces[0].velocity_m_per_s[1] = 1e-9;
  arrive(force);
  for (int i = 0; i < 250; ++i) tick();
  EXPECT_NEAR(device.applied[0], -2, 1e-6);
  for (int i = 0; i < 375; ++i) tick();
  EXPECT_NEAR(device.applied[0], -1, 1e-2);
  for (int i = 0; i < 400; ++i) tick();
  EXPECT_EQ(device.applied[0], 0.0);
  EXPECT_EQ(records.last.policy, record::ForcePolicy::dropped);
}

TEST_F(SessionModels, StayWhenTheServerIsSilentIfTheyStandStill) {
  begin();
  arrive(pressed());
  for (int i = 0; i < 1500; ++i) tick();
  EXPECT_NEAR(device.applied[0], -2, 1e-6);
  EXPECT_EQ(records.last.policy, record::ForcePolicy::fresh);
}

TEST_F(SessionModels, OfWhatStandsStayWhenTheServerIsSilentAlsoBesideAForceThatFades) {
  begin();
  auto near_its_rim = pressed();
  near_its_rim.answer.model.surfaces[0].radius_m = 0.003;
  arrive(near_its_rim);
  tick();
  EXPECT_NEAR(device.applied[0], -2, 1e-6);
  for (int i = 0; i < 1100; ++i) tick();
  EXPECT_NEAR(device.applied[0], -2 * 2.0 / 3, 1e-5) << "a third of it was held";
}

TEST_F(SessionModels, OfWhatStandsFadeWhenTheServerEndsTheSession) {
  begin();
  const auto last = pressed();
  arrive(wire::Bye{.session = kSession});
  arrive(last);  // overtaken by it
  tick();
  EXPECT_NEAR(device.applied[0], -2, 1e-6);
  for (int i = 0; i < 1100; ++i) tick();
  EXPECT_EQ(device.applied[0], 0.0);
}

TEST_F(SessionModels, AreAsLateAsBeforeWhereAReadingIsUnusable) {
  begin();
  auto moving = pressed();
  moving.answer.model.surfaces[0].velocity_m_per_s = {1e-9, 0, 0};
  arrive(moving);
  for (int i = 0; i < 300; ++i) tick();
  ASSERT_EQ(records.last.policy, record::ForcePolicy::fading);
  device.position[0] = std::numeric_limits<double>::quiet_NaN();
  tick();
  EXPECT_EQ(records.last.policy, record::ForcePolicy::fading);
}

TEST_F(SessionModels, AreRenderedWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  begin();
  arrive(pressed());
  tick();
  (void)sent<wire::MotionSample>();
  // What the fake link keeps is allocated by it.
  const wire::EnvironmentForce force = [&] {
    tick();
    return pressed();
  }();
  AnswerRendering answers;
  const Vector place = device.position;
  const test::AllocationGuard guard;
  (void)answers.render(force, {.now = clock.time, .place = place, .server_parts_alone = false});
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST_F(SessionModels, AndASceneComeRunAndEndWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto scene = packed_wall();
  const handover::Announcement& announced = scene->announcement();
  ASSERT_EQ(announced.pieces, 1U);
  device.position = Vector::Constant(1, -0.01);
  tick();
  arrive(wire::Welcome{.client_nonce = sent<wire::Hello>().at(0).client_nonce,
                       .session = kSession,
                       .offer = {.manifest_sha256 = announced.hash,
                                 .manifest_bytes = static_cast<std::uint32_t>(announced.manifest_bytes),
                                 .pieces = 1}});
  tick();
  ASSERT_EQ(session.state(), SessionState::active);
  build();
  tick();
  wire::EnvironmentForce in_the_air = pressed();
  in_the_air.answer.contact_normal.resize(0);
  in_the_air.answer.penetration_m = 0;
  in_the_air.answer.server_parts_N = in_the_air.answer.force;
  const auto prepare = [this](const wire::Message& message) {
    const auto bytes = codec.encode(message);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  };
  const auto piece =
      prepare(wire::ScenePiece{.session = kSession, .transmission = 1, .number = 0, .content = scene->piece(0)});
  const auto force = prepare(in_the_air);
  const auto bye = prepare(wire::Bye{.session = kSession});
  link.reserve(10);
  events.kinds.reserve(100);
  link.keep = false;

  std::uint64_t operations = 0;
  const auto live = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      const test::AllocationGuard guard;
      tick();
      operations += guard.heap_operations();
    }
  };
  link.arrive_again(piece, kServer);
  live(1);
  build();
  link.arrive_again(force, kServer);
  live(5);
  EXPECT_EQ(records.last.local.rows(), 1) << "the scene runs";
  EXPECT_EQ(records.last.model.rows(), 1) << "and a model of the rest";
  device.position[0] = 0.002;
  live(5);
  ASSERT_EQ(records.last.local.rows(), 1);
  EXPECT_NEAR(records.last.local[0], -2, 1e-6);
  live(300);
  link.arrive_again(bye, kServer);
  live(10);
  EXPECT_EQ(records.last.local.rows(), 0) << "it went with the session";
  live(1300);
  EXPECT_EQ(operations, 0U);
}

}  // namespace
}  // namespace forcebound::client
