// Case 5 for the law without a ledger: what fba-more remembers from tick to tick. Built twice: for the usual run, and
// for the long one with 1e9 ticks.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "forcebound/control/more_conservative_law.hpp"
#include "tests/support/ideal_device.hpp"

namespace forcebound::control {
namespace {

using test::kDamping_N_s_per_m;
using test::kPeriod_s;

constexpr long double kB_N_per_m = static_cast<long double>(kDamping_N_s_per_m) / kPeriod_s;

/// A_n = R + xi d'B d - f'd, with a share of the energy reserved by the last force [Kim 2015, eq. 24-34].
class MemoryInLongDouble {
 public:
  void move(long double d) {
    available_J_ = reserved_J_ > 0 ? reserved_J_ + xi_ * kB_N_per_m * d * d - force_N_ * d : kB_N_per_m * d * d;
  }
  void commit(double force_N) {
    const long double needed_J = static_cast<long double>(force_N) * force_N / (4 * kB_N_per_m);
    const bool forget = force_N == 0 || !(available_J_ > 0);
    reserved_J_ = forget ? 0 : available_J_;
    xi_ = !forget && needed_J < available_J_ ? needed_J / available_J_ : 1;
    force_N_ = force_N;
  }
  [[nodiscard]] double available_J() const { return static_cast<double>(available_J_); }

 private:
  long double available_J_ = 0;
  long double reserved_J_ = 0;
  long double xi_ = 1;
  long double force_N_ = 0;
};

TEST(HardCase05, MemoryOfTheMoreConservativeLawIsExactAfterManyTicksAndResumes) {
  constexpr std::size_t kPlaces = 4096;
  constexpr std::uint64_t kTicks = FORCEBOUND_LEDGER_TICKS;
  std::mt19937_64 random(5);
  std::array<double, kPlaces> places{};
  std::array<double, kPlaces> requests{};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    places[i] = 1e-5 * static_cast<double>(random() % 1000) / 1000;
    requests[i] = static_cast<double>(random() % 1000) / 500 - 1;
  }
  const Damping damping = Damping::from_matrix(Matrix::Constant(1, 1, kDamping_N_s_per_m));
  Motion motion;
  motion.interval_s = kPeriod_s;
  motion.position = Vector::Zero(1);
  motion.damping = &damping;
  Vector request = Vector::Zero(1);
  MoreConservativeLaw law(1, kPeriod_s);
  MemoryInLongDouble expected;
  law.credit(motion);
  law.commit(request);
  double before_m = 0;
  double error_J = 0;
  double most_J = 0;
  for (std::uint64_t n = 1; n <= kTicks; ++n) {
    // A copy is a saved state.
    if (n == kTicks / 2) law = MoreConservativeLaw(law);
    const std::size_t at = (n * 2654435761U) % kPlaces;
    motion.position[0] = places[at];
    expected.move(static_cast<long double>(places[at]) - before_m);
    before_m = places[at];
    law.credit(motion);
    error_J = std::max(error_J, std::abs(law.energy_J() - expected.available_J()));
    most_J = std::max(most_J, law.energy_J());
    request[0] = requests[at];
    const Vector force = law.bound(request);
    law.commit(force);
    expected.commit(force[0]);
  }
  EXPECT_LT(error_J, 1e-9);
  EXPECT_GT(most_J, 1e-6) << "no energy was stored";
}

}  // namespace
}  // namespace forcebound::control
