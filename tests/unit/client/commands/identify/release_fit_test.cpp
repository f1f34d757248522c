#include "forcebound/client/commands/identify/release_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "forcebound/client/commands/identify/energy_balance.hpp"

namespace forcebound::client::commands::identify {
namespace {

struct Joint {
  double mass = 0.2;
  double damping = 2;
  double friction = 0.3;
  double latency_s = 730e-6;
  double hold_s = 3.1e-3;
  double step = 20e-6;
};

/// Way and speed in closed form: m v' = drive - D v.
struct Motion {
  double way = 0;
  double speed = 0;

  void go(const Joint& joint, double drive, double time_s) {
    const double rate = joint.damping / joint.mass;
    const double end = drive / joint.damping;
    const double decay = std::exp(-rate * time_s);
    way += end * time_s + (speed - end) * (1 - decay) / rate;
    speed = end + (speed - end) * decay;
  }
};

/// From rest, pushed from tick 0 on and let go at tick `ticks`.
Slide slide_of(const Joint& joint, double force, int ticks, Slide::End end, double direction, double begin) {
  constexpr double kTick_s = 1e-3;
  Slide slide{.direction = direction, .begin = begin, .end = end, .released = static_cast<std::size_t>(ticks)};
  const int last = ticks - (end == Slide::End::silence ? 1 : 0);
  const double off_s = last * kTick_s + joint.latency_s + (end == Slide::End::silence ? joint.hold_s : 0);
  const auto place = [&](double time_s) {
    Motion motion;
    const double pushed_s = std::clamp(time_s - joint.latency_s, 0.0, off_s - joint.latency_s);
    motion.go(joint, force - joint.friction, pushed_s);
    if (time_s > off_s) motion.go(joint, -joint.friction, time_s - off_s);
    return motion;
  };
  for (int tick = 0;; ++tick) {
    const Motion motion = place(tick * kTick_s);
    if (tick > ticks + 10 && motion.speed < 0.02) break;
    const double at = joint.step * (std::round((begin + motion.way) / joint.step) - std::round(begin / joint.step));
    slide.samples.push_back({tick * kTick_s, at, tick * kTick_s, tick < ticks ? force : 0});
  }
  return slide;
}

std::vector<Slide> slides_of(const Joint& joint) {
  std::vector<Slide> slides;
  for (int i = 0; i < 24; ++i) {
    const double force = joint.friction + 0.5 + 0.5 * (i % 3);
    const auto end = i % 4 == 3 ? Slide::End::silence : Slide::End::zero;
    slides.push_back(slide_of(joint, force, 60 + 10 * (i % 5), end, i % 2 == 0 ? 1 : -1, 1e-3 * std::sin(7.0 * i)));
  }
  return slides;
}

TEST(ReleaseFit, FindsMassDampingFrictionAndTimesOfMotionsInClosedForm) {
  const Joint joint;
  const auto fit = fit_releases(slides_of(joint), joint.step, {.mass = 0.1, .damping = 1, .friction = 0.1});
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->slides, 24);
  EXPECT_NEAR(fit->mass, joint.mass, 0.01 * joint.mass);
  EXPECT_NEAR(fit->damping, joint.damping, 0.02 * joint.damping);
  EXPECT_NEAR(fit->friction, joint.friction, 0.02 * joint.friction);
  EXPECT_NEAR(fit->weight, 0, 0.01 * joint.friction);
  EXPECT_NEAR(fit->latency_s.value, joint.latency_s, 5 * fit->latency_s.error);
  EXPECT_LT(fit->latency_s.error, 50e-6);
  ASSERT_TRUE(fit->hold_s);
  EXPECT_NEAR(fit->hold_s->value, joint.hold_s, 5 * fit->hold_s->error);
  EXPECT_LT(fit->residual, 0.35) << "rounding alone leaves 0.29 steps";
}

// The readings that say that a slide has become slow are more often rounded down: where they were used themselves,
// latencies of coarse encoders came out 10 to 40 us too small, several standard errors.
TEST(ReleaseFit, IsNotBiasedByACoarseEncoder) {
  const Joint joint{.mass = 0.02, .damping = 0.6, .friction = 0.3, .latency_s = 730e-6, .step = 100e-6};
  std::vector<Slide> slides;
  for (int i = 0; i < 300; ++i) {
    const auto end = i % 8 == 7 ? Slide::End::silence : Slide::End::zero;
    slides.push_back(slide_of(joint, joint.friction + 0.2 + 0.003 * (i % 37), 60 + i % 11, end, i % 2 == 0 ? 1 : -1,
                              1e-3 * std::sin(7.0 * i)));
  }
  const auto fit = fit_releases(slides, joint.step, {.mass = 0.01, .damping = 0.5, .friction = 0.2});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->latency_s.value, joint.latency_s, 3 * fit->latency_s.error);
  EXPECT_LT(fit->latency_s.error, 20e-6);
  EXPECT_GT(fit->latency_s.slides, 100) << "nearly all of them tell it";
}

TEST(ReleaseFit, NeedsFourSlides) {
  const Joint joint;
  auto slides = slides_of(joint);
  slides.resize(3);
  EXPECT_FALSE(fit_releases(slides, joint.step, {.mass = 0.1, .damping = 1, .friction = 0.1}));
}

TEST(EnergyBalance, BoundsDampingAndFrictionFromBelow) {
  const Joint joint;
  const auto slides = slides_of(joint);
  const auto fit = fit_releases(slides, joint.step, {.mass = 0.1, .damping = 1, .friction = 0.1});
  ASSERT_TRUE(fit);
  const EnergyBalance balance =
      balance_energy(slides, *fit, {.encoder_step = joint.step, .latency_error_s = 20e-6, .confidence = 0.999});
  EXPECT_TRUE(balance.damping.refused.empty()) << balance.damping.refused;
  EXPECT_LE(balance.damping.bound, joint.damping);
  EXPECT_GE(balance.damping.bound, 0.7 * joint.damping);
  EXPECT_LE(balance.friction.bound, joint.friction);
  EXPECT_GE(balance.friction.bound, 0.7 * joint.friction);
  EXPECT_NEAR(balance.mass, joint.mass, 0.02 * joint.mass);
}

TEST(EnergyBalance, TakesTheFrictionOfThePlaceWhereItIsLeast) {
  // The same joint with half the friction beyond 10 mm: slides that begin there tell it.
  Joint joint;
  Joint easy = joint;
  easy.friction = 0.5 * joint.friction;
  std::vector<Slide> slides = slides_of(joint);
  for (Slide slide : slides_of(easy)) {
    slide.begin += 0.2;
    slides.push_back(std::move(slide));
  }
  const auto fit = fit_releases(slides, joint.step, {.mass = 0.1, .damping = 1, .friction = 0.1});
  ASSERT_TRUE(fit);
  const EnergyBalance balance =
      balance_energy(slides, *fit, {.encoder_step = joint.step, .latency_error_s = 20e-6, .confidence = 0.999});
  EXPECT_LE(balance.friction.bound, easy.friction);
}

}  // namespace
}  // namespace forcebound::client::commands::identify
