#include "forcebound/server/simulator/simulator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "forcebound/server/simulator/simulator_environment.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/simulator/slow_worlds.hpp"

namespace forcebound::server {
namespace {

constexpr double kTick_s = 1e-3;

/// A client's environment of a simulator, moved by hand.
class MovedProbe {
 public:
  explicit MovedProbe(const EnvironmentKind& kind) : environment_(kind.make({.degrees_of_freedom = 3}).environment) {}

  /// A tick later, there. @returns the answer
  Answer to(double z_m, bool wants_model = false) {
    position_[2] = z_m;
    now_ += time::from_seconds(kTick_s);
    return environment_->respond(
        {.position = position_, .device_time = now_, .server_time = now_, .wants_model = wants_model});
  }
  void pause_s(double pause_s) { now_ += time::from_seconds(pause_s); }

 private:
  std::unique_ptr<Environment> environment_;
  Vector position_ = Vector::Zero(3);
  Nanoseconds now_ = std::chrono::seconds{1};
};

EnvironmentKind kind_of(const std::shared_ptr<Simulator>& simulator) {
  return simulator_environment({.name = "slow", .simulated = "slow"}, simulator);
}

Touch floor_at(double z_m) { return {.place_m = {0, 0, z_m}, .normal = Point::UnitZ()}; }

TEST(ASimulator, IsNotFeltBeforeItsFirstReport) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{}, 1);
  MovedProbe probe(kind_of(simulator));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(probe.to(-0.01 * i / 100).force.isZero(0));
}

/// Of three seconds: of the hand, which pushes a box along, and of what the simulator was told.
struct Impulses {
  double felt_Ns = 0;
  double given_Ns = 0;
  double had_Ns = 0;  ///< by the box
};

Impulses impulses(int ticks_of_step) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{.mass_kg = 0.01}, 1);
  MovedProbe probe(kind_of(simulator));
  SlowSled sled(0.6, 0);
  Impulses all;
  double z_m = 0.004;
  for (int tick = 0; tick < 3000; ++tick) {
    Simulator::Probe asked;
    if (tick % ticks_of_step == 0 && simulator->probes({&asked, 1}) == 1) {
      double pushed_Ns = 0;
      for (const auto& push : std::span(asked.pushes).first(asked.push_count)) pushed_Ns += push.impulse_Ns.z();
      const double step_s = ticks_of_step * kTick_s;
      sled.step(step_s, {.force_N = {0, 0, pushed_Ns / step_s}});
      all.given_Ns -= pushed_Ns;
      EXPECT_TRUE(simulator->report(asked.client, std::array{sled.touch(asked.place_m)}));
    }
    z_m -= 0.03 * kTick_s;
    all.felt_Ns += kTick_s * probe.to(z_m).force[2];
  }
  all.had_Ns = -sled.momentum_Ns();
  return all;
}

/// But for what the simulator's own steps get wrong: this one's box is half a step ahead.
TEST(ASimulator, GivesItsBodiesWhatTheHandFelt) {
  for (const auto& [ticks, share] : {std::pair(17, 0.15), std::pair(2, 0.03)}) {
    const Impulses all = impulses(ticks);
    ASSERT_GT(all.felt_Ns, 0.01);
    EXPECT_NEAR(all.given_Ns, all.felt_Ns, share * all.felt_Ns) << ticks;
    EXPECT_NEAR(all.had_Ns, all.given_Ns, 1e-12) << ticks;
  }
}

TEST(ASimulator, TellsAClientWhatItsProbeMeets) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{.radius_m = 0.005}, 1);
  MovedProbe probe(kind_of(simulator));
  Answer answer;
  for (int tick = 0; tick < 200; ++tick) {
    answer = probe.to(0.004, true);
    Simulator::Probe asked;
    if (tick % 10 != 0 || simulator->probes({&asked, 1}) == 0) continue;
    (void)simulator->report(asked.client, std::array{floor_at(0)});
  }
  // Its lowest point is 1 mm below the floor.
  EXPECT_NEAR(answer.force[2], 2, 0.05);
  EXPECT_NEAR(answer.penetration_m, 0.001, 1e-9);
  ASSERT_TRUE(answer.model.has_mass);
  EXPECT_TRUE(local_model::is_sound(answer.model));
  EXPECT_EQ(answer.model.mass.contact_count, 1U);
  EXPECT_NEAR(answer.model.mass.place_m.z(), 0.005, 1e-4);
  EXPECT_NEAR(answer.model.mass.force_N.z(), answer.force[2], 1e-6);
}

TEST(ASimulator, FadesInSilenceAndComesBackWithoutAStep) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{}, 1);
  MovedProbe probe(kind_of(simulator));
  const auto report = [&] {
    Simulator::Probe asked;
    if (simulator->probes({&asked, 1}) == 0) return;
    EXPECT_TRUE(simulator->report(asked.client, std::array{floor_at(0)}));
  };
  double z_N = 0;
  const auto run = [&](int ticks, bool reports) {
    double jump_N = 0;
    for (int i = 0; i < ticks; ++i) {
      if (reports && i % 17 == 0) report();
      const double before_N = z_N;
      z_N = probe.to(-0.001).force[2];
      jump_N = std::max(jump_N, std::abs(z_N - before_N));
    }
    return jump_N;
  };
  EXPECT_LT(run(500, true), 0.3);
  EXPECT_NEAR(z_N, 2, 0.05);
  EXPECT_LT(run(200, false), 0.01);
  EXPECT_NEAR(z_N, 2, 0.05);
  EXPECT_EQ(simulator->counts().silences, 0U);
  EXPECT_LT(run(425, false), 0.01);
  EXPECT_EQ(simulator->counts().silences, 1U);
  EXPECT_NEAR(z_N, 1, 0.1);
  EXPECT_LT(run(1000, false), 0.01);
  EXPECT_EQ(z_N, 0);
  EXPECT_LT(run(500, true), 0.3);
  EXPECT_NEAR(z_N, 2, 0.05);
  (void)run(300, false);
  EXPECT_EQ(simulator->counts().silences, 2U);
}

/// That a client sent nothing for a while says nothing of the simulator.
TEST(ASimulator, IsNotCalledSilentForAClientThatPauses) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{}, 1);
  MovedProbe probe(kind_of(simulator));
  (void)probe.to(0);
  probe.pause_s(0.4);
  (void)probe.to(0);
  EXPECT_EQ(simulator->counts().silences, 0U);
}

/// A hand that feels nothing gives nothing.
TEST(ASimulator, IsNotPushedByAHandForWhichItsForceHasFaded) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{}, 1);
  MovedProbe probe(kind_of(simulator));
  Simulator::Probe asked;
  for (int tick = 0; tick < 500; ++tick) {
    (void)probe.to(-0.001);
    if (tick % 17 != 0 || simulator->probes({&asked, 1}) == 0) continue;
    (void)simulator->report(asked.client, std::array{floor_at(0)});
  }
  ASSERT_GT(asked.push_count, 0U);
  EXPECT_LT(asked.pushes[0].impulse_Ns.z(), -0.02);
  for (int tick = 0; tick < 1200; ++tick) (void)probe.to(-0.001);
  ASSERT_EQ(simulator->probes({&asked, 1}), 1U);
  for (int tick = 0; tick < 100; ++tick) (void)probe.to(-0.001);
  ASSERT_EQ(simulator->probes({&asked, 1}), 1U);
  for (const auto& push : std::span(asked.pushes).first(asked.push_count)) EXPECT_TRUE(push.impulse_Ns.isZero(0));
}

TEST(ASimulator, DoesNotAllocateWhileProbesMove) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{}, 1);
  MovedProbe probe(kind_of(simulator));
  (void)probe.to(0);
  Simulator::Probe asked;
  ASSERT_EQ(simulator->probes({&asked, 1}), 1U);
  ASSERT_TRUE(simulator->report(asked.client, std::array{floor_at(0)}));
  const test::AllocationGuard guard;
  for (int i = 0; i < 300; ++i) (void)probe.to(-1e-5 * i, true);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(ASimulator, SeatsAsManyAsItHasRoomFor) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{}, 2);
  const EnvironmentKind kind = kind_of(simulator);
  EXPECT_EQ(kind.sessions_max, 2U);
  EXPECT_TRUE(kind.accepts(3) && kind.accepts(6) && !kind.accepts(2));
  MovedProbe first(kind);
  std::array<Simulator::Probe, 3> asked;
  {
    MovedProbe second(kind);
    EXPECT_THROW(MovedProbe{kind}, std::logic_error);
    for (int i = 0; i < 3; ++i) {
      (void)first.to(0);
      (void)second.to(0);
    }
    ASSERT_EQ(simulator->probes(asked), 2U);
    EXPECT_NE(asked[0].client, asked[1].client);
  }
  ASSERT_EQ(simulator->probes(asked), 1U);
  EXPECT_FALSE(simulator->report(99, {}));
  EXPECT_FALSE(simulator->report(0, {}));
  EXPECT_EQ(simulator->counts().reports_refused, 2U);
}

/// Whatever a simulator says that is within its bounds.
TEST(ASimulator, GivesForcesThatAreFinite) {
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{.radius_m = 1, .mass_kg = 1e-3}, 1);
  MovedProbe probe(kind_of(simulator));
  for (int tick = 0; tick < 2000; ++tick) {
    const Answer answer = probe.to(std::sin(tick) * 50, true);
    ASSERT_TRUE(answer::is_sound(answer, 3)) << tick;
    ASSERT_TRUE(local_model::is_sound(answer.model)) << tick;
    Simulator::Probe asked;
    if (tick % 3 != 0 || simulator->probes({&asked, 1}) == 0) continue;
    const double sign = tick % 2 == 0 ? 1 : -1;
    (void)simulator->report(asked.client, std::array{Touch{.place_m = {-50 * sign, 50, 50},
                                                           .normal = sign * Point::UnitZ(),
                                                           .velocity_m_per_s = {50, -50, 50 * sign},
                                                           .mobility_per_kg = 1e4 * Eigen::Matrix3d::Identity(),
                                                           .others_N = {5e4, 5e4, -5e4},
                                                           .spring_N_per_m = 1e6,
                                                           .damper_N_s_per_m = 1e5,
                                                           .dry_friction_N = 1e5,
                                                           .friction = 10}});
  }
}

}  // namespace
}  // namespace forcebound::server
