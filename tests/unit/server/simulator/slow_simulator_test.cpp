#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/firm_device.hpp"
#include "tests/unit/server/simulator/slow_block.hpp"
#include "tests/unit/server/simulator/slow_worlds.hpp"

/// Device -- client ==( delay )== server -- probe at 1 kHz -- a simulator that steps at 60 or 200 Hz
namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using control::Vector;

/// Presses along -z and lets go, over and over; or strokes along x, always pressing.
class PressingHand final : public device::Operator {
 public:
  explicit PressingHand(bool strokes) : strokes_(strokes) {}
  std::string_view name() const noexcept override { return "presses"; }
  const device::Hand& hand() const noexcept override { return hand_; }
  int degrees_of_freedom() const noexcept override { return 3; }
  std::string description() const override { return "presses"; }
  Target target(double time_s) const noexcept override {
    constexpr double kTurn_rad_per_s = 2 * std::numbers::pi * 0.8;
    constexpr double kSwing_m = 0.004;
    constexpr double kStroke = 4;
    Target target{.position = Vector::Zero(3), .velocity = Vector::Zero(3)};
    const double swing_m = kSwing_m * std::cos(kTurn_rad_per_s * time_s);
    const double speed_m_per_s = -kSwing_m * kTurn_rad_per_s * std::sin(kTurn_rad_per_s * time_s);
    if (strokes_) {
      target.position << kStroke * swing_m, 0, -0.003;
      target.velocity[0] = kStroke * speed_m_per_s;
    } else {
      target.position[2] = swing_m - 0.001;
      target.velocity[2] = speed_m_per_s;
    }
    return target;
  }

 private:
  bool strokes_;
  device::Hand hand_{.mass_kg = 0.1, .stiffness_N_per_m = 1000, .damping_N_s_per_m = 5};
};

/// What was felt.
class Felt final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    all_N.emplace_back(tick.applied.head<3>());
    depth_m.push_back(std::max(0.0, -tick.position[2]));
    if (all_N.size() > 1) jump_N = std::max(jump_N, (all_N.back() - all_N[all_N.size() - 2]).norm());
  }

  std::vector<Point> all_N;
  std::vector<double> depth_m;  ///< below where the surface was at first
  double jump_N = 0;            ///< largest change in a tick
  double least_P_J = 0;
};

struct Setting {
  std::shared_ptr<SlowWorld> (*world)();
  double rate_Hz = 60;
  bool held = false;  ///< as people do without
  Nanoseconds each_way{0};
  bool local = true;
  bool strokes = false;
};

EnvironmentKind kind_of(const Setting& setting) {
  const std::shared_ptr<SlowWorld> world = setting.world();
  const double step_s = 1 / setting.rate_Hz;
  if (setting.held) {
    return {.name = "slow", .degrees_of_freedom = {3}, .make = [=](const ClientFacts&) {
              return MadeEnvironment{.environment = std::make_unique<HeldBeside>(world, step_s)};
            }};
  }
  const auto simulator = std::make_shared<Simulator>(ProbeFacts{}, 1);
  EnvironmentKind kind = simulator_environment({.name = "slow", .simulated = "slow"}, simulator);
  kind.make = [=, make = kind.make](const ClientFacts& client) {
    MadeEnvironment made = make(client);
    made.environment = std::make_unique<SteppedBeside>(std::move(made.environment), simulator, world, step_s);
    return made;
  };
  return kind;
}

Felt felt_in(const Setting& setting) {
  Felt felt;
  netem::NetemParameters delay;
  if (setting.each_way > 0ns) delay = netem::parse_netem("delay " + std::to_string(setting.each_way / 1ms) + "ms");
  sim::ClosedLoop loop({.device = sim::firm_device(),
                        .hand = "",
                        .make_hand = [&] { return std::make_unique<PressingHand>(setting.strokes); },
                        .law = "fba-exact",
                        .scene = nullptr,
                        .network = {.up = delay, .down = delay},
                        .own_environment = kind_of(setting),
                        .renders_locally = setting.local},
                       {&felt});
  loop.run(6s);
  felt.least_P_J = nlohmann::json::parse(loop.close().to_json())["passivity"]["minimum_J"].get<double>();
  return felt;
}

/// RMS of the difference over RMS, from the second second on.
double error(const Felt& felt, const Felt& truth) {
  double differs = 0;
  double all = 0;
  for (std::size_t i = 1000; i < std::min(felt.all_N.size(), truth.all_N.size()); ++i) {
    differs += (felt.all_N[i] - truth.all_N[i]).squaredNorm();
    all += truth.all_N[i].squaredNorm();
  }
  return std::sqrt(differs / all);
}

/// Of force over depth, from the second second on: least squares.
double stiffness_N_per_m(const Felt& felt) {
  double force_Nm = 0;
  double depth_m2 = 0;
  for (std::size_t i = 1000; i < felt.all_N.size(); ++i) {
    force_Nm += felt.all_N[i].z() * felt.depth_m[i];
    depth_m2 += felt.depth_m[i] * felt.depth_m[i];
  }
  return force_Nm / depth_m2;
}

template <class World>
std::shared_ptr<SlowWorld> of() {
  return std::make_shared<World>();
}

/// At 60 and 200 Hz, as good as the same at 1 kHz through that network. @returns the error of the latter
double expect_as_if_fast(Setting setting, const Felt& truth) {
  setting.rate_Hz = 1000;
  const double at_once = error(felt_in(setting), truth);
  for (const double rate_Hz : {60.0, 200.0}) {
    setting.rate_Hz = rate_Hz;
    const std::string what =
        std::to_string(std::lround(rate_Hz)) + " Hz, " + std::to_string(setting.each_way / 1ms) + " ms";
    SCOPED_TRACE(what);
    const Felt felt = felt_in(setting);
    const double displayed = stiffness_N_per_m(felt) / stiffness_N_per_m(truth);
    std::printf("%s: %.3f (1 kHz: %.3f), displayed %.3f\n", what.c_str(), error(felt, truth), at_once, displayed);
    EXPECT_LE(error(felt, truth), at_once + 0.05);
    EXPECT_GE(displayed, 0.95);
    EXPECT_LE(felt.jump_N, 0.5);
    EXPECT_GE(felt.least_P_J, -1e-9);
  }
  return at_once;
}

class SlowSimulator : public testing::TestWithParam<std::shared_ptr<SlowWorld> (*)()> {};

/// The same simulator at 1 kHz without a network is what it should feel like.
TEST_P(SlowSimulator, FeelsAsTheSameAt1kHz) {
  const Felt truth = felt_in({.world = GetParam(), .rate_Hz = 1000});
  for (const Nanoseconds each_way : {Nanoseconds(0ms), Nanoseconds(50ms)}) {
    const double at_once = expect_as_if_fast({.world = GetParam(), .each_way = each_way}, truth);
    const Felt held = felt_in({.world = GetParam(), .rate_Hz = 60, .held = true, .each_way = each_way});
    std::printf("held at 60 Hz, %lld ms: %.3f\n", static_cast<long long>(each_way / 1ms), error(held, truth));
    if (each_way > 0ns) {
      EXPECT_GT(error(held, truth), at_once + 0.2);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, SlowSimulator,
                         testing::Values(&of<SlowWall>, &of<SlowSled>, &of<SlowColumn>, &of<SlowBlock>));

/// Over 32 mm, with up to 80 mm/s.
TEST(ASlowSoftBlock, FeelsAsTheSameAt1kHzWhenItIsStroked) {
  const Felt truth = felt_in({.world = &of<SlowBlock>, .rate_Hz = 1000, .strokes = true});
  for (const Nanoseconds each_way : {Nanoseconds(0ms), Nanoseconds(50ms)})
    (void)expect_as_if_fast({.world = &of<SlowBlock>, .each_way = each_way, .strokes = true}, truth);
}

/// From 2 s on 10 mm higher, at once.
class JumpingWall final : public SlowWorld {
 public:
  void step(double step_s, const Pushed& /*pushed*/) override { time_s_ += step_s; }
  [[nodiscard]] Touch touch(const Point& probe_m) const override {
    return {.place_m = {probe_m.x(), probe_m.y(), time_s_ < 2 ? 0 : 0.01}, .normal = Point::UnitZ()};
  }

 private:
  double time_s_ = 0;
};

TEST(AJumpOfASimulator, PushesTheHandOutInNoBlow) {
  const Felt felt = felt_in({.world = &of<JumpingWall>, .rate_Hz = 60});
  // 10 mm of a coupling of 2000 N/m would be 20 N at once.
  EXPECT_LE(felt.jump_N, 1);
  EXPECT_TRUE(std::ranges::any_of(felt.all_N, [](const Point& force_N) { return force_N.z() > 5; }));
  EXPECT_GE(felt.least_P_J, -1e-9);
}

}  // namespace
}  // namespace forcebound::server
