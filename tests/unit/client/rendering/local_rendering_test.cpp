#include <gtest/gtest.h>

#include <tuple>

#include "tests/support/meshes.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/client/rendering/stroked_loop.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::sim {
namespace {

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
  EXPECT_TRUE(local["rendering"]["model_trust"].is_null()) << "a plane has no model";
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
  slow.handover.bytes_per_s = 80e3;
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

TEST(LocalRendering, IsNotAskedForWithALawThatHasAServerSideLaw) {
  ClosedLoop::Settings with_waves = settings(handover::scene_of(kFrictionPlane), "delay 10ms", true);
  with_waves.law = "wave";
  ClosedLoop loop(with_waves);
  loop.run(100ms);
  EXPECT_EQ(loop.local(), nullptr);
  EXPECT_EQ(summary_of(loop)["rendering"]["asked"], "remote");
}

}  // namespace
}  // namespace forcebound::sim
