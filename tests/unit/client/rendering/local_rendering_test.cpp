#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "tests/support/meshes.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/firm_device.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr const char* kFrictionPlane = R"(
[[object]]
name = 'plane'
shape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }
effects = ['surface', 'friction']
[object.surface]
stiffness_N_per_m = 10000
[object.friction]
static_coefficient = 0.3
dynamic_coefficient = 0.2
)";

/// Sees how the force came about on each tick.
class Watch final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    ++ticks;
    if (tick.rendering != record::ForceOrigin::held) {
      if (local == 0) first_local = tick.time;
      ++local;
    }
    if (tick.policy == record::ForcePolicy::fading) ++faded;
    if (tick.applied.norm() > 0.01 && first_force == Nanoseconds::zero()) first_force = tick.time;
    last = tick;
  }
  void on_force(const record::ForceRecord&) noexcept override {}

  int ticks = 0;
  int local = 0;
  int faded = 0;
  Nanoseconds first_local{0};
  Nanoseconds first_force{0};
  record::TickRecord last;
};

ClosedLoop::Settings settings(const std::shared_ptr<const scene::Scene>& scene, const std::string& netem, bool local,
                              const std::string& hand = "stroke:height_m=0.01,depth_m=0.004") {
  const auto parameters = netem.empty() ? netem::NetemParameters{} : netem::parse_netem(netem);
  return {.device = firm_device(),
          .hand = hand,
          .law = "fba-exact",
          .scene = scene,
          .network = {.up = parameters, .down = parameters, .trace = {}, .seed = 7},
          .settle_s = 0.5,
          .renders_locally = local};
}

json summary_of(ClosedLoop& loop) { return json::parse(loop.close().to_json()); }

/// Mean force over mean depth.
double displayed(const json& summary) {
  return summary["force_N"]["mean"].get<double>() / summary["penetration_m"]["mean"].get<double>();
}

//   firm device, stroke -- session, scene ==( 50 ms each way, loss )== server
TEST(LocalRendering, ShowsAPlaneBehindATenthOfASecondAsWithoutANetwork) {
  const auto scene = handover::scene_of(kFrictionPlane);
  Watch near_watch;
  ClosedLoop near(settings(scene, "", false), {&near_watch});
  near.run(4s);
  const json without = summary_of(near);
  Watch far_watch;
  ClosedLoop far(settings(scene, "delay 50ms 5ms loss 5%", true), {&far_watch});
  far.run(4s);
  const json local = summary_of(far);
  ClosedLoop held(settings(scene, "delay 50ms 5ms loss 5%", false));
  held.run(4s);
  const json remote = summary_of(held);

  ASSERT_GT(displayed(without), 5000);
  EXPECT_GT(displayed(local), 0.99 * displayed(without));
  EXPECT_LT(displayed(remote), 0.5 * displayed(without));
  EXPECT_LE(far_watch.first_force - near_watch.first_force, 1ms) << "felt when it is touched";
  EXPECT_GE(local["passivity"]["minimum_J"].get<double>(), -1e-9);
  EXPECT_GT(local["rendering"]["at_client"].get<double>(), 0.9);
  EXPECT_EQ(remote["rendering"]["at_client"], 0);
  EXPECT_LT(far_watch.first_local, 500ms) << "after two round trips and what was lost of them";
}

TEST(LocalRendering, NeedsFewMotionsWhereTheSceneAtTheClientIsAllThereIs) {
  const auto scene = handover::scene_of(kFrictionPlane);
  ClosedLoop::Settings each_tick = settings(scene, "delay 50ms 5ms loss 5%", true);
  ClosedLoop::Settings as_needed = each_tick;
  as_needed.send_rate.as_needed = true;
  ClosedLoop many(std::move(each_tick));
  ClosedLoop few(std::move(as_needed));
  many.run(4s);
  few.run(4s);
  const json often = summary_of(many);
  const json rarely = summary_of(few);
  EXPECT_GT(often["sent"], 3500);
  EXPECT_LT(rarely["sent"], 1000) << "each tick until the scene is there, then 20 a second";
  EXPECT_GT(displayed(rarely), 0.99 * displayed(often));
  EXPECT_GE(rarely["passivity"]["minimum_J"].get<double>(), -1e-9);
}

TEST(LocalRendering, IsTheSameForTheSameSeed) {
  const auto run = [] {
    Watch watch;
    ClosedLoop loop(settings(handover::mesh_scene(test::ball(0.03, 40)), "delay 30ms 10ms loss 10%", true,
                             "stroke:height_m=0.01,depth_m=0.004,offset_z_m=0.03"),
                    {&watch});
    loop.run(2s);
    return std::tuple(watch.local, watch.last.applied, watch.last.position, watch.last.local_scene);
  };
  EXPECT_EQ(run(), run());
}

TEST(LocalRendering, FeelsAMeshWhileItsPiecesStillCome) {
  ClosedLoop::Settings slow = settings(handover::mesh_scene(test::ball(0.03, 60)), "delay 20ms loss 10%", true,
                                       "stroke:height_m=0.01,depth_m=0.004,offset_z_m=0.03");
  slow.handover.bytes_per_s = 60e3;
  Watch watch;
  ClosedLoop loop(std::move(slow), {&watch});
  loop.run(1500ms);
  EXPECT_GT(watch.local, 500) << "there is contact long before all is there";
  EXPECT_EQ(loop.local()->phase(), client::BuildPhase::wanting);
  loop.run(9s);
  EXPECT_EQ(loop.local()->phase(), client::BuildPhase::whole);
  const json summary = summary_of(loop);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0.85);
  EXPECT_GT(displayed(summary), 800);
}

TEST(LocalRendering, GoesOnThroughABlackoutAsIfNothingWere) {
  const auto scene = handover::scene_of(kFrictionPlane);
  ClosedLoop::Settings whole = settings(scene, "delay 10ms", true);
  ClosedLoop::Settings dead = whole;
  dead.faults.push_back({.kind = ClosedLoop::Fault::Kind::blackout, .at = 2s, .length = 3s});
  Watch one;
  Watch other;
  ClosedLoop a(std::move(whole), {&one});
  ClosedLoop b(std::move(dead), {&other});
  a.run(4s);
  b.run(4s);
  EXPECT_EQ(one.last.position, other.last.position);
  EXPECT_EQ(one.last.applied, other.last.applied);
  EXPECT_EQ(other.last.rendering, record::ForceOrigin::at_client);
  b.run(3s);
  EXPECT_EQ(b.session().state(), client::SessionState::active);
}

TEST(LocalRendering, KeepsTheSceneWhileItsServerStartsAnew) {
  ClosedLoop::Settings restarted = settings(handover::scene_of(kFrictionPlane), "delay 10ms", true);
  restarted.faults.push_back({.kind = ClosedLoop::Fault::Kind::server_killed, .at = 2s, .length = 500ms});
  Watch watch;
  ClosedLoop loop(std::move(restarted), {&watch});
  loop.run(2s);
  const int before = watch.local;
  loop.run(5s);
  EXPECT_EQ(watch.local - before, 5000);
  EXPECT_EQ(loop.local()->builder().counts().scenes_built, 1U);
}

/// Along x on each tick, of the scene at the client and as the server said it.
class Along final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (tick.local.rows() == 3) local_N[tick.time] = tick.local[0];
    if (tick.local.rows() == 3 && tick.force_sequence != 0) remote_N[tick.time - tick.force_age] = tick.remote[0];
  }
  void on_force(const record::ForceRecord&) noexcept override {}
  std::map<Nanoseconds, double> local_N;
  std::map<Nanoseconds, double> remote_N;  // by the time of the motion that it answers
};

/// A force that changes with the scene's time.
std::shared_ptr<const scene::Scene> driven() {
  return handover::scene_of(R"(
[[field]]
name = 'drive'
effects = ['drive']
[field.drive]
waveform = 'sine'
direction = [1, 0, 0]
amplitude_N = 0.5
frequency_Hz = 1
)");
}

//   firm device, stroke -- session with a hold time of 30 ms, drive ==( 5 ms each way )== server
TEST(LocalRendering, WithMotionsAsNeededLetsNothingFadeWhoseServerAnswers) {
  ClosedLoop::Settings as_needed = settings(driven(), "delay 5ms", true);
  as_needed.policy = {.hold = 30ms, .drop = 100ms};
  as_needed.send_rate.as_needed = true;
  Watch watch;
  ClosedLoop loop(std::move(as_needed), {&watch});
  loop.run(1s);
  const int before = watch.faded;
  ASSERT_EQ(watch.last.rendering, record::ForceOrigin::at_client);
  loop.run(2s);
  EXPECT_EQ(watch.faded, before);
  EXPECT_LT(loop.totals().sent, 2000U) << "far fewer than one on each tick";
}

/// Compares both for each motion that was read since then. How many there were.
int compare(const Along& along, Nanoseconds since) {
  int compared = 0;
  for (const auto& [time, force_N] : along.remote_N) {
    const auto here = along.local_N.find(time);
    if (time < since || here == along.local_N.end()) continue;
    ++compared;
    EXPECT_NEAR(here->second, force_N, 1e-9) << time.count();
  }
  return compared;
}

TEST(LocalRendering, HasTheSameTimeAsTheScenesOfTheServer) {
  Along along;
  ClosedLoop loop(settings(driven(), "delay 50ms", true), {&along});
  loop.run(3s);
  EXPECT_GT(compare(along, 0s), 1000);
}

//   firm device, stroke -- session, plane and drive ==( cut off from 1 s on )== server
TEST(LocalRendering, LetsWhatDrivesTheDeviceFadeWithoutItsServerAndKeepsSurfaces) {
  ClosedLoop::Settings alone = settings(handover::scene_of(R"(
[[object]]
name = 'plane'
shape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }
effects = ['surface']
[object.surface]
stiffness_N_per_m = 10000
[[field]]
name = 'drive'
effects = ['drive']
[field.drive]
waveform = 'square'
direction = [1, 0, 0]
amplitude_N = 0.5
frequency_Hz = 1
)"),
                                        "delay 10ms", true);
  alone.faults.push_back({.kind = ClosedLoop::Fault::Kind::blackout, .at = 1s, .length = 10s});
  Watch watch;
  ClosedLoop loop(std::move(alone), {&watch});
  loop.run(1s);
  ASSERT_EQ(watch.last.local.rows(), 3);
  EXPECT_NEAR(std::abs(watch.last.local[0]), 0.5, 1e-9);
  loop.run(1100ms);
  double pushed_N = 0;
  for (int i = 0; i < 1500; ++i) {
    loop.run(1ms);
    ASSERT_EQ(watch.last.local.rows(), 3);
    EXPECT_EQ(watch.last.local[0], 0);
    pushed_N = std::max(pushed_N, watch.last.local[2]);
  }
  EXPECT_GT(pushed_N, 0.1);
  EXPECT_EQ(watch.last.policy, record::ForcePolicy::dropped);
}

//   firm device, stroke -- session, weight and push ==( cut off from 1 s on )== server
TEST(LocalRendering, LetsAConstantForceFadeWithoutItsServerAndKeepsWhatIsInTheHand) {
  ClosedLoop::Settings alone = settings(handover::scene_of(R"(
[[field]]
name = 'weight'
effects = ['gravity']
[field.gravity]
mass_kg = 0.1
direction = [0, 0, -1]
gravity_m_per_s2 = 10
[[field]]
name = 'push'
effects = ['constant_force']
[field.constant_force]
force_N = [0.5, 0, 0]
)"),
                                        "delay 10ms", true);
  alone.faults.push_back({.kind = ClosedLoop::Fault::Kind::blackout, .at = 1s, .length = 10s});
  Watch watch;
  ClosedLoop loop(std::move(alone), {&watch});
  loop.run(1s);
  ASSERT_EQ(watch.last.local.rows(), 3);
  EXPECT_TRUE(watch.last.local.isApprox(Vector(scene::Point(0.5, 0, -1))));
  loop.run(1500ms);
  ASSERT_EQ(watch.last.local.rows(), 3);
  EXPECT_TRUE(watch.last.local.isApprox(Vector(scene::Point(0, 0, -1))));
}

/// One answer after that time becomes the server's end of the session.
SimulatedNetwork::Tamper bye_after(Nanoseconds time) {
  return [time, said = false, reader = std::make_shared<wire::Codec>(), writer = std::make_shared<wire::Codec>()](
             std::span<const std::byte> datagram, Nanoseconds now) mutable {
    const auto decoded = reader->decode(datagram);
    const auto* const message = std::get_if<wire::Message>(&decoded);
    const auto* const force = message != nullptr ? std::get_if<wire::EnvironmentForce>(message) : nullptr;
    if (said || now < time || force == nullptr) return datagram;
    said = true;
    return writer->encode(wire::Bye{.session = force->session});
  };
}

TEST(LocalRendering, HasTheTimeOfTheServersSceneInALaterSessionToo) {
  Along along;
  ClosedLoop loop(settings(driven(), "delay 50ms", true), {&along});
  loop.network().set_tamper(bye_after(1s));
  loop.run(3500ms);
  EXPECT_EQ(loop.totals().reconnects, 1U);
  EXPECT_GT(compare(along, 2s), 1000);
}

TEST(LocalRendering, LetsTimeGoOnWhenItsServerStartsAnew) {
  ClosedLoop::Settings restarted = settings(driven(), "delay 10ms", true);
  restarted.faults.push_back({.kind = ClosedLoop::Fault::Kind::server_killed, .at = 2s, .length = 50ms});
  Along along;
  ClosedLoop loop(std::move(restarted), {&along});
  loop.run(4s);
  EXPECT_EQ(loop.totals().reconnects, 1U);
  int compared = 0;
  for (const auto& [time, force_N] : along.local_N) {
    // Two of its periods later; before and after the restart.
    const auto later = along.local_N.find(time + 2s);
    if (time < 1s || time >= 1900ms || later == along.local_N.end()) continue;
    ++compared;
    EXPECT_NEAR(later->second, force_N, 1e-9) << time.count();
  }
  EXPECT_GT(compared, 800);
}

TEST(LocalRendering, HasASecondVisitFromTheCache) {
  const test::TemporaryFolder folder;
  for (int visit = 0; visit < 2; ++visit) {
    ClosedLoop::Settings cached = settings(handover::mesh_scene(test::ball(0.03, 30)), "delay 10ms", true,
                                           "stroke:height_m=0.01,depth_m=0.004,offset_z_m=0.03");
    cached.scene_cache = folder.path() / "cache";
    ClosedLoop loop(std::move(cached));
    loop.run(2s);
    const json summary = summary_of(loop);
    EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0.9);
    EXPECT_EQ(summary["rendering"]["scenes_from_cache"], visit);
    EXPECT_EQ(summary["rendering"]["scene_pieces"].get<int>() > 0, visit == 0);
  }
}

/// Changes pieces of the scene on their way, with a checksum that agrees.
SimulatedNetwork::Tamper lie(std::function<void(wire::ScenePiece&, std::vector<std::byte>&)> change) {
  return [change = std::move(change), reader = std::make_shared<wire::Codec>(),
          writer = std::make_shared<wire::Codec>()](std::span<const std::byte> datagram, Nanoseconds) {
    const auto decoded = reader->decode(datagram);
    const auto* const message = std::get_if<wire::Message>(&decoded);
    if (message == nullptr || !std::holds_alternative<wire::ScenePiece>(*message)) return datagram;
    wire::ScenePiece piece = std::get<wire::ScenePiece>(*message);
    std::vector<std::byte> content(piece.content.begin(), piece.content.end());
    change(piece, content);
    piece.content = content;
    return writer->encode(piece);
  };
}

struct Lie {
  const char* name;
  void (*change)(wire::ScenePiece&, std::vector<std::byte>&);
};

class LyingServers : public ::testing::TestWithParam<Lie> {};

TEST_P(LyingServers, AreRefusedInOneLineAndTheirForcesHeld) {
  Watch watch;
  ClosedLoop loop(settings(handover::mesh_scene(test::ball(0.03, 30)), "delay 10ms", true,
                           "stroke:height_m=0.01,depth_m=0.004,offset_z_m=0.03"),
                  {&watch});
  loop.network().set_tamper(lie(GetParam().change));
  loop.run(4s);
  const json summary = summary_of(loop);
  EXPECT_EQ(summary["faults"]["scenes_refused"], 1);
  EXPECT_THAT(summary["faults"]["notes"].dump(), testing::HasSubstr("scene refused: "));
  EXPECT_EQ(watch.last.rendering, record::ForceOrigin::held);
  EXPECT_GT(summary["force_N"]["mean"], 0.1) << "forces are held instead";
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

constexpr Lie kLies[]{{"Manifest",
                       [](wire::ScenePiece& piece, std::vector<std::byte>& bytes) {
                         if (piece.number == 0) bytes[40] ^= std::byte{64};
                       }},
                      {"Geometry",
                       [](wire::ScenePiece& piece, std::vector<std::byte>& bytes) {
                         if (piece.number > 5) bytes[40] ^= std::byte{64};
                       }},
                      {"Number", [](wire::ScenePiece& piece, std::vector<std::byte>&) { piece.number += 100'000; }},
                      {"Length",
                       [](wire::ScenePiece& piece, std::vector<std::byte>& bytes) {
                         if (piece.number > 5) bytes.resize(1130);
                       }},
                      {"Order", [](wire::ScenePiece& piece, std::vector<std::byte>&) {
                         if (piece.number > 5) piece.number ^= 1;
                       }}};

INSTANTIATE_TEST_SUITE_P(LocalRendering, LyingServers, testing::ValuesIn(kLies),
                         [](const auto& lie) { return lie.param.name; });

/// Changes answers on their way, with a checksum that agrees.
SimulatedNetwork::Tamper answer_with(std::function<void(wire::EnvironmentForce&)> change) {
  return [change = std::move(change), reader = std::make_shared<wire::Codec>(),
          writer = std::make_shared<wire::Codec>()](std::span<const std::byte> datagram, Nanoseconds) {
    const auto decoded = reader->decode(datagram);
    const auto* const message = std::get_if<wire::Message>(&decoded);
    if (message == nullptr || !std::holds_alternative<wire::EnvironmentForce>(*message)) return datagram;
    wire::EnvironmentForce force = std::get<wire::EnvironmentForce>(*message);
    change(force);
    return writer->encode(force);
  };
}

TEST(LocalRendering, StaysPassiveWhenAModelPushesAwayFromItsPlaceEverHarder) {
  Watch watch;
  ClosedLoop loop(settings(handover::scene_of(kFrictionPlane), "delay 10ms", true), {&watch});
  loop.network().set_tamper(answer_with([](wire::EnvironmentForce& force) {
    force.answer.model.by_device_clock = true;
    force.answer.model.has_field = true;
    force.answer.model.field.place_m = scene::Point(force.position);
    force.answer.model.field.jacobian_N_per_m = 1e6 * Eigen::Matrix3d::Identity();
    force.answer.model.field.radius_m = 10;
  }));
  loop.run(3s);
  EXPECT_EQ(watch.last.model_trust, 0) << "it is given up";
  const json summary = summary_of(loop);
  EXPECT_EQ(summary["faults"]["models_refused"], 0) << "it can be";
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

TEST(LocalRendering, CountsUnsoundModelsAndHoldsTheirForces) {
  Watch watch;
  ClosedLoop loop(settings(handover::scene_of(kFrictionPlane), "delay 10ms", true), {&watch});
  loop.network().set_tamper(answer_with([](wire::EnvironmentForce& force) {
    force.answer.model.surfaces[0].stiffness_N_per_m = -1000 * Eigen::Matrix3d::Identity();
    force.answer.model.surfaces[0].radius_m = 1;
    force.answer.model.surface_count = 1;
  }));
  loop.run(1s);
  EXPECT_EQ(watch.last.model.rows(), 0);
  const json summary = summary_of(loop);
  EXPECT_GT(summary["faults"]["models_refused"], 500);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

TEST(LocalRendering, PassesOverPiecesOfAnotherSession) {
  Watch watch;
  ClosedLoop loop(settings(handover::scene_of(kFrictionPlane), "delay 10ms", true), {&watch});
  loop.network().set_tamper(lie([](wire::ScenePiece& piece, std::vector<std::byte>&) { piece.session ^= 1; }));
  loop.run(1s);
  EXPECT_EQ(watch.local, 0);
  EXPECT_EQ(loop.local()->pieces_received(), 0U);
  EXPECT_EQ(loop.local()->phase(), client::BuildPhase::wanting);
}

TEST(LocalRendering, AddsTissueByItsLocalModel) {
  const auto scene = handover::scene_of(std::string(kFrictionPlane) + R"(
[[tissue]]
name = 'pad'
shape = { kind = 'block', center_m = [0, 0, -0.02], size_m = [0.1, 0.1, 0.04], cells = [4, 4, 2] }
held = { through_m = [0, 0, -0.039], normal = [0, 0, 1] }
young_Pa = 5000
poisson = 0.4
contact_stiffness_N_per_m = 500
)");
  ASSERT_EQ(scene->rendering_of_part(1).how, scene::Rendering::modelled);
  Watch watch;
  ClosedLoop loop(settings(scene, "delay 10ms", true), {&watch});
  loop.run(3s);
  const json summary = summary_of(loop);
  EXPECT_GT(summary["rendering"]["modelled"].get<double>(), 0.3);
  EXPECT_LT(summary["rendering"]["held"].get<double>(), 0.3);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

/// Where the device was on each tick.
class Path final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (tick.position.rows() == 3) heights_m.push_back(tick.position[2]);
  }
  void on_force(const record::ForceRecord&) noexcept override {}
  std::vector<double> heights_m;
};

double rms_apart_m(const Path& one, const Path& other) {
  const std::size_t ticks = std::min(one.heights_m.size(), other.heights_m.size());
  double sum = 0;
  for (std::size_t i = 0; i < ticks; ++i) sum += std::pow(one.heights_m[i] - other.heights_m[i], 2);
  return std::sqrt(sum / static_cast<double>(ticks));
}

json play(const std::shared_ptr<const scene::Scene>& scene, const std::string& netem, bool local, Path& path) {
  ClosedLoop loop(settings(scene, netem, local), {&path});
  loop.run(4s);
  return summary_of(loop);
}

//   firm device, stroke -- session ==( 50 ms each way, loss )== server -- pad
TEST(LocalRendering, LetsAHandGoOnAPadBehindATenthOfASecondMuchAsWithoutANetwork) {
  const auto scene = handover::scene_of(R"(
[[tissue]]
name = 'pad'
shape = { kind = 'block', center_m = [0, 0, -0.02], size_m = [0.1, 0.1, 0.04], cells = [4, 4, 2] }
held = { through_m = [0, 0, -0.039], normal = [0, 0, 1] }
young_Pa = 20000
poisson = 0.4
contact_stiffness_N_per_m = 2000
)");
  Path near;
  Path far;
  Path held;
  (void)play(scene, "", false, near);
  const json summary = play(scene, "delay 50ms 5ms loss 5%", true, far);
  (void)play(scene, "delay 50ms 5ms loss 5%", false, held);
  EXPECT_LT(rms_apart_m(far, near), 0.3 * rms_apart_m(held, near));
  EXPECT_GT(summary["rendering"]["modelled"].get<double>(), 0.5);
  EXPECT_EQ(summary["faults"]["models_refused"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

//   firm device, stroke -- session ==( 50 ms each way, loss )== server -- puck on its coupling, stop
TEST(LocalRendering, LetsAHandPushABodyAgainstAStopBehindATenthOfASecondMuchAsWithoutANetwork) {
  if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const auto scene = handover::scene_of(R"(
[[body]]
name = 'puck'
probes = ['puck']
stiffness_N_per_m = 600
damping_N_s_per_m = 4
mjcf_text = '''
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <geom type="box" pos="0 0 -0.07" size="0.2 0.2 0.05" solref="0.004 1"/>
    <body name="puck">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.02" mass="0.1" solref="0.004 1"/>
    </body>
  </worldbody>
</mujoco>
'''
)");
  Path near;
  Path far;
  Path held;
  (void)play(scene, "", false, near);
  const json summary = play(scene, "delay 50ms 5ms loss 5%", true, far);
  (void)play(scene, "delay 50ms 5ms loss 5%", false, held);
  EXPECT_LT(rms_apart_m(far, near), 0.1 * rms_apart_m(held, near));
  EXPECT_GT(summary["rendering"]["modelled"].get<double>(), 0.5);
  EXPECT_EQ(summary["faults"]["models_refused"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

//   firm device, the scene's own hand -- session, scene ==( 50 ms each way, loss )== server -- dome
TEST(LocalRendering, LetsAHandStrokeTheDomeThatShipsBehindATenthOfASecondMuchAsWithoutANetwork) {
  const auto scene = server::load_scene("dome");
  const server::SuggestedHand suggested = server::suggested_hand(scene);
  const auto run = [&](const std::string& netem, bool local, Path& path) {
    ClosedLoop::Settings with_hand = settings(scene, netem, local, suggested.hand);
    with_hand.device = device::load_device(suggested.device);
    ClosedLoop loop(std::move(with_hand), {&path});
    loop.run(5s);
    return summary_of(loop);
  };
  Path near;
  Path far;
  Path held;
  (void)run("", false, near);
  const json summary = run("delay 50ms 5ms loss 5%", true, far);
  (void)run("delay 50ms 5ms loss 5%", false, held);
  EXPECT_LT(rms_apart_m(far, near), 0.1 * rms_apart_m(held, near));
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0.8);
  EXPECT_EQ(summary["faults"]["scenes_refused"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

TEST(LocalRendering, LeavesALawWithAHalfAtTheServerAlone) {
  ClosedLoop::Settings waves = settings(handover::scene_of(kFrictionPlane), "delay 10ms", true);
  waves.law = "wave";
  Watch watch;
  ClosedLoop loop(std::move(waves), {&watch});
  loop.run(1s);
  EXPECT_EQ(watch.local, 0);
  EXPECT_EQ(loop.local()->phase(), client::BuildPhase::nothing);
}

}  // namespace
}  // namespace forcebound::sim
