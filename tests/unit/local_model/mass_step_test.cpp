#include "forcebound/local_model/mass_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::local_model {
namespace {

constexpr double kBall_kg = 0.1;

Body body_of(double mass_kg) { return {.mobility_per_kg = Eigen::Matrix3d::Identity() / mass_kg}; }

/// Below a ball at the origin, which touches it.
Contact floor_below() {
  return {
      .normal = Point::UnitX(), .compliance_per_kg = 1.75, .stiffness_per_s2 = 6e4, .damping_per_s = 500, .met = {}};
}

/// A ball without a coupling, under a force.
struct PushedBall {
  explicit PushedBall(const Point& force_N) {
    mass.body = body_of(kBall_kg);
    mass.body.bias_m_per_s2 = force_N / kBall_kg;
  }
  Contact& touch(const Contact& contact) {
    mass.contact_count = 1;
    return mass.contacts[0] = contact;
  }
  void begin() { state = state_of(mass); }
  void go_on(double duration_s, double step_s = 1e-3) {
    const auto steps = std::lround(duration_s / step_s);
    for (std::int64_t i = 0; i < steps; ++i) step(mass, {}, step_s, 1, state);
  }
  Mass mass{};
  MassState state{};
};

TEST(MassStep, MovesAFreeMassByItsForceOverItsMass) {
  PushedBall ball({0.2, -0.1, 0});
  ball.begin();
  ball.go_on(0.1);
  EXPECT_LT((ball.state.velocity_m_per_s - Point(0.2, -0.1, 0)).norm(), 1e-12);
  step(ball.mass, {}, 1e-3, 0, ball.state);
  EXPECT_LT((ball.state.velocity_m_per_s - Point(0.2, -0.1, 0)).norm(), 1e-12) << "of what pulls nothing is left";
}

// Critically damped: r = -v t exp(-w t) with w = sqrt(s), deepest at w t = 1; from w t = 2 on the contact would pull.
TEST(MassStep, StopsAMassAtWhatStandsStill) {
  constexpr double kComes_m_per_s = 0.2;
  for (const double step_s : {1e-3, 1e-5}) {
    PushedBall ball(Point::Zero());
    ball.mass.body.velocity_m_per_s = {-kComes_m_per_s, 0, 0};
    Contact& contact = ball.touch(floor_below());
    contact.gap_m = 0.001;
    contact.compliance_per_kg = 0;
    contact.damping_per_s = 2 * std::sqrt(contact.stiffness_per_s2);
    ball.begin();
    double deepest_m = 0;
    for (int i = 0; i < std::lround(0.1 / step_s); ++i) {
      ball.go_on(step_s, step_s);
      deepest_m = std::max(deepest_m, -ball.state.met[0].gap_m);
    }
    const double expected_m = kComes_m_per_s / (std::numbers::e * std::sqrt(contact.stiffness_per_s2));
    const double leaves_m_per_s = kComes_m_per_s * std::exp(-2);
    const double tolerance = step_s < 1e-4 ? 0.02 : 0.5;
    EXPECT_NEAR(deepest_m, expected_m, tolerance * expected_m) << step_s;
    EXPECT_NEAR(ball.state.velocity_m_per_s.x(), leaves_m_per_s, tolerance * leaves_m_per_s) << step_s;
  }
}

TEST(MassStep, LetsAMassLeaveWhatItTouches) {
  PushedBall ball({0.1, 0, 0});
  ball.touch(floor_below()).friction = 1;
  ball.begin();
  ball.go_on(0.1);
  EXPECT_NEAR(ball.state.velocity_m_per_s.x(), 0.1, 1e-12);
  EXPECT_NEAR(ball.state.met[0].gap_m, ball.state.place_m.x(), 1e-15);
}

// MuJoCo's law at rest: s r = -R l, since neither r'' nor r' is left, and a is what l makes up for.
TEST(MassStep, RestsWhereStiffnessTimesGapIsComplianceTimesForce) {
  for (const double step_s : {1e-3, 1e-5}) {
    PushedBall ball({-1, 0, 0});
    ball.touch(floor_below());
    ball.begin();
    ball.go_on(0.2, step_s);
    EXPECT_GT(ball.state.met[0].gap_m, -1e-4);
    EXPECT_NEAR(ball.state.met[0].gap_m, ball.state.place_m.x(), 1e-12);
    EXPECT_NEAR(ball.state.met[0].pressed_Ns / step_s, 1, 1e-6);
    if (step_s > 1e-4) continue;
    EXPECT_NEAR(ball.state.met[0].gap_m, -1.75 / 6e4, 0.02 * 1.75 / 6e4);
  }
}

TEST(MassStep, PushesAnotherBodyAheadWithTheMassOfBoth) {
  PushedBall ball({-0.4, 0, 0});
  ball.touch(floor_below()).met = body_of(0.3);
  ball.begin();
  ball.go_on(0.2);
  const MassState::Met& met = ball.state.met[0];
  EXPECT_NEAR(ball.state.velocity_m_per_s.x(), -0.2, 2e-3);
  EXPECT_NEAR(met.velocity_m_per_s.x(), -0.2, 2e-3);
  EXPECT_NEAR(kBall_kg * ball.state.velocity_m_per_s.x() + 0.3 * met.velocity_m_per_s.x(), -0.08, 1e-12);
  EXPECT_NEAR(met.moved_m.x(), -0.02, 5e-4);
}

TEST(MassStep, DryFrictionHoldsAMassUpToItsLimitAndSlowsItBeyond) {
  const Point along = Point(1, -2, 2) / 3;
  for (const double force_N : {0.49, 1.0}) {
    PushedBall ball(force_N * along);
    ball.mass.body.dry_friction_N = 0.5;
    ball.begin();
    ball.go_on(0.1);
    const double left_N = std::max(0.0, force_N - 0.5);
    EXPECT_LT((ball.state.velocity_m_per_s - 0.1 * left_N / kBall_kg * along).norm(), 1e-9) << force_N;
  }
}

TEST(MassStep, DryFrictionHoldsWhatIsMetUpToItsLimitAndSlowsItBeyond) {
  PushedBall ball({-0.4, 0, 0});
  Contact& contact = ball.touch(floor_below());
  contact.met = body_of(0.3);
  contact.met.dry_friction_N = 0.45;
  ball.begin();
  ball.go_on(0.2);
  EXPECT_NEAR(ball.state.met[0].moved_m.x(), 0, 1e-5);
  contact.met.dry_friction_N = 0.2;
  ball.begin();
  ball.go_on(0.2);
  EXPECT_NEAR(ball.state.met[0].velocity_m_per_s.x(), -0.1, 2e-3);
}

// A plate that goes along the surface alone, pressed by 1 N.
TEST(MassStep, FrictionDragsWhatIsMetAlongTheSurfaceUpToItsLimit) {
  constexpr double kPlate_kg = 0.5;
  constexpr double kFriction = 0.3;
  for (const double along_N : {0.2, 1.0}) {
    PushedBall ball({-1, 0, along_N});
    Contact& contact = ball.touch(floor_below());
    contact.friction = kFriction;
    contact.met.mobility_per_kg = Point(0, 1 / kPlate_kg, 1 / kPlate_kg).asDiagonal();
    ball.begin();
    ball.go_on(0.2);
    const double together_N = along_N * kPlate_kg / (kPlate_kg + kBall_kg);
    const double dragged_N = std::min(together_N, kFriction);
    EXPECT_NEAR(ball.state.met[0].velocity_m_per_s.z(), 0.2 * dragged_N / kPlate_kg, 2e-3) << along_N;
    EXPECT_NEAR(ball.state.velocity_m_per_s.z(), 0.2 * (along_N - dragged_N) / kBall_kg, 1e-2) << along_N;
    EXPECT_LE(ball.state.met[0].rubbed_Ns.norm(), kFriction * ball.state.met[0].pressed_Ns + 1e-12);
  }
}

TEST(MassStep, SpringAndDamperOfWhatIsMetGiveTheirForceAtRest) {
  PushedBall ball({-1, 0, 0});
  Contact& button = ball.touch(floor_below());
  button.met = body_of(0.05);
  button.met.spring_N_per_m = 400;
  button.met.damper_N_s_per_m = 2;
  ball.begin();
  ball.go_on(1);
  EXPECT_NEAR(ball.state.met[0].moved_m.x(), -1.0 / 400, 1e-6);
  EXPECT_NEAR(ball.state.place_m.x(), -1.0 / 400, 1e-4);
  button.met.spring_N_per_m = 0;
  button.met.damper_N_s_per_m = 20;
  ball.begin();
  ball.go_on(1);
  EXPECT_NEAR(ball.state.met[0].velocity_m_per_s.x(), -1.0 / 20, 1e-6);
}

TEST(MassStep, StopsWhatIsMetAtItsTravelAndItsReturn) {
  constexpr double kAbout_m = 2e-5;  // what six sweeps leave
  PushedBall ball({-3, 0, 0});
  Contact& button = ball.touch(floor_below());
  button.met = body_of(0.05);
  button.met.spring_N_per_m = 400;
  button.travel_m = 0.002;
  button.return_m = 0.001;
  ball.begin();
  double least_m = 0;
  double most_m = 0;
  const auto watch = [&](double duration_s) {
    for (int i = 0; i < std::lround(duration_s / 1e-3); ++i) {
      ball.go_on(1e-3);
      least_m = std::min(least_m, ball.state.met[0].moved_m.x());
      most_m = std::max(most_m, ball.state.met[0].moved_m.x());
    }
  };
  watch(0.5);
  EXPECT_NEAR(ball.state.met[0].moved_m.x(), -0.002, kAbout_m);
  EXPECT_NEAR(ball.state.place_m.x(), -0.002, 2.5e-4) << "it lies on it, at 3 N";
  EXPECT_NEAR(ball.state.velocity_m_per_s.x(), 0, 1e-6);
  ball.mass.body.bias_m_per_s2.setZero();
  button.met.bias_m_per_s2.x() = 40;
  watch(0.5);
  EXPECT_NEAR(ball.state.met[0].moved_m.x(), 0.001, kAbout_m);
  EXPECT_GE(least_m, -0.002 - kAbout_m);
  EXPECT_LE(most_m, 0.001 + kAbout_m);
}

TEST(MassStep, AContactEndsAtItsRadius) {
  PushedBall ball({-1, 0, 0});
  ball.mass.body.velocity_m_per_s = {0, 0.1, 0};
  ball.touch(floor_below()).radius_m = 0.005;
  ball.begin();
  ball.go_on(0.05);
  EXPECT_GT(ball.state.place_m.x(), -1e-4);
  ball.go_on(0.05);
  EXPECT_NEAR(ball.state.place_m.x(), -10 * 0.05 * 0.05 / 2, 1e-3);
}

TEST(MassStep, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  PushedBall ball({-1, 0, 0.1});
  ball.touch(floor_below()).met = body_of(0.3);
  const test::AllocationGuard guard;
  ball.begin();
  ball.go_on(0.1);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

/// Log-uniform draws of what a mass and what it meets may be, with gaps that are not below zero and nothing that pulls.
class DrawnMasses {
 public:
  explicit DrawnMasses(std::uint64_t seed) : random_(seed) {}

  Mass draw(bool rough) {
    Mass mass{.stiffness_N_per_m = zero_or(1, 1e6), .damping_N_s_per_m = zero_or(1e-2, 1e4), .body = body(rough)};
    mass.contact_count = static_cast<std::uint32_t>(random_() % 4);
    for (Contact& contact : mass.contacts) {
      contact = {.normal = direction(),
                 .gap_m = zero_or(1e-6, 1e-3),
                 .compliance_per_kg = zero_or(1e-2, 100),
                 .stiffness_per_s2 = zero_or(1e2, 1e6),
                 .damping_per_s = zero_or(1, 2e3),
                 .friction = rough ? zero_or(0.1, 2) : 0,
                 .met = random_() % 2 == 0 ? Body{} : body(rough)};
      if (random_() % 2 == 0) contact.travel_m = zero_or(1e-5, 1e-2);
      if (random_() % 2 == 0) contact.return_m = zero_or(1e-5, 1e-2);
    }
    return mass;
  }
  double size(double least, double most) {
    return least * std::pow(most / least, std::uniform_real_distribution(0.0, 1.0)(random_));
  }
  Point direction() {
    std::normal_distribution<double> normal;
    const double x = normal(random_);
    const double y = normal(random_);
    return Point(x, y, normal(random_)).normalized();
  }

 private:
  double zero_or(double least, double most) { return random_() % 4 == 0 ? 0 : size(least, most); }

  /// Free, or on a rail.
  Body body(bool rough) {
    const bool free = random_() % 2 == 0;
    const double mass_kg = size(2e-4, 10);
    const Point rail = direction();
    Body body = body_of(mass_kg);
    if (!free) body.mobility_per_kg = rail * rail.transpose() / mass_kg;
    body.velocity_m_per_s = size(1e-3, 1) * (free ? direction() : rail);
    body.spring_N_per_m = zero_or(1, 1e6);
    body.damper_N_s_per_m = zero_or(1e-2, 1e4);
    body.dry_friction_N = rough ? zero_or(1e-2, 10) : 0;
    return body;
  }
  std::mt19937_64 random_;
};

double energy_J(const Body& body, const Point& velocity_m_per_s, const Point& moved_m) {
  // Along a rail the largest eigenvalue is the only one.
  const double per_kg = body.mobility_per_kg.trace() / (body.mobility_per_kg(0, 1) == 0 ? 3 : 1);
  if (per_kg == 0) return 0;
  return velocity_m_per_s.squaredNorm() / per_kg / 2 + body.spring_N_per_m * moved_m.squaredNorm() / 2;
}

double energy_J(const Mass& mass, const MassState& state, const DevicePoint& device) {
  double sum_J = energy_J(mass.body, state.velocity_m_per_s, state.place_m - mass.place_m);
  sum_J += mass.stiffness_N_per_m * (device.place_m - state.place_m).squaredNorm() / 2;
  for (std::uint32_t i = 0; i < mass.contact_count; ++i) {
    sum_J += energy_J(mass.contacts.at(i).met, state.met.at(i).velocity_m_per_s, state.met.at(i).moved_m);
  }
  return sum_J;
}

/// A device at rest that pulls at a drawn mass.
struct EnergyBalance {
  explicit EnergyBalance(const Mass& drawn, DrawnMasses& draws)
      : mass(drawn),
        step_s(draws.size(1e-4, 1e-3)),
        device{.place_m = draws.size(1e-4, 0.05) * draws.direction()},
        state(state_of(mass)) {}
  double of_next_step_J() {
    step(mass, device, step_s, 1, state);
    return energy_J(mass, state, device);
  }
  Mass mass;
  double step_s;
  DevicePoint device;
  MassState state;
  double first_J = energy_J(mass, state, device);
};

constexpr std::uint64_t kDrawnMasses = 2000;
constexpr int kStepsOfEach = 100;

TEST(MassStep, NoStepOfAMassWithoutContactsAddsEnergy) {
  for (std::uint64_t seed = 1; seed <= kDrawnMasses; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    DrawnMasses draws(seed);
    Mass mass = draws.draw(false);
    mass.contact_count = 0;
    EnergyBalance balance(mass, draws);
    double before_J = balance.first_J;
    for (int i = 0; i < kStepsOfEach; ++i) {
      const double now_J = balance.of_next_step_J();
      ASSERT_LE(now_J, before_J + 1e-9 * balance.first_J) << "step " << i;
      before_J = now_J;
    }
  }
}

TEST(MassStep, DryFrictionAddsNoEnergy) {
  for (std::uint64_t seed = 1; seed <= kDrawnMasses; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    DrawnMasses draws(seed);
    Mass mass = draws.draw(true);
    mass.contact_count = 0;
    EnergyBalance balance(mass, draws);
    for (int i = 0; i < kStepsOfEach; ++i) ASSERT_LE(balance.of_next_step_J(), (1 + 1e-9) * balance.first_J) << i;
  }
}

// At least critically damped, as bodies are that touch.

}  // namespace
}  // namespace forcebound::local_model
