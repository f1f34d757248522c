#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <variant>

#include "tests/unit/client/rendering/stroked_loop.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::sim {
namespace {

/// Along x on each tick, of the scene at the client and as the server said it.
class Along final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (tick.local.rows() == 3) local_N[tick.time] = tick.local[0];
    if (tick.local.rows() == 3 && tick.force_sequence != 0) remote_N[tick.time - tick.force_age] = tick.remote[0];
  }
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

}  // namespace
}  // namespace forcebound::sim
