#include "tests/support/random_ticks.hpp"

#include <cstddef>
#include <random>

namespace forcebound::test {
namespace {

using Numbers = std::vector<double>;

class Generator {
 public:
  explicit Generator(const RandomRun& run) : run_(run), random_(run.seed), size_(std::size_t(run.degrees_of_freedom)) {}

  std::vector<ReferenceTick> ticks() {
    std::vector<ReferenceTick> result;
    std::vector<Numbers> damping = random_damping();
    Numbers position(size_, 0.0);
    for (int i = 0; i < run_.ticks; ++i) {
      if (i % 25 == 0) begin_phase();
      if (run_.damping_changes) damping = random_damping();
      if (uniform(0, 1) > 0.05) position = moved(position);
      result.push_back({position, request(position), damping});
    }
    return result;
  }

 private:
  enum class Phase { free, wall, force };

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  Numbers random_numbers(double size) {
    Numbers result(size_);
    for (double& value : result) value = uniform(-size, size);
    return result;
  }

  /// A A' + I: symmetric to the last bit, positive definite, with every entry at work.
  std::vector<Numbers> random_damping() {
    std::vector<Numbers> root;
    for (std::size_t i = 0; i < size_; ++i) root.push_back(random_numbers(3));
    std::vector<Numbers> damping(size_, Numbers(size_, 0.0));
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = i == j ? 1.0 : 0.0;
        for (std::size_t k = 0; k < size_; ++k) sum += root[i][k] * root[j][k];
        damping[i][j] = damping[j][i] = sum;
      }
    }
    return damping;
  }

  void begin_phase() {
    phase_ = static_cast<Phase>(std::uniform_int_distribution<int>(0, 2)(random_));
    velocity_ = random_numbers(run_.motion_m);
    stiffness_N_per_m_ = run_.force_N / run_.motion_m * uniform(0.01, 3);
  }

  Numbers moved(Numbers position) {
    const Numbers tremor = random_numbers(0.2 * run_.motion_m);
    for (std::size_t i = 0; i < size_; ++i) position[i] += velocity_[i] + tremor[i];
    return position;
  }

  Numbers request(const Numbers& position) {
    if (phase_ == Phase::force) return random_numbers(run_.force_N);
    Numbers result(size_, 0.0);
    if (phase_ == Phase::free) return result;
    for (std::size_t i = 0; i < size_; ++i) {
      if (position[i] > 0) result[i] = -stiffness_N_per_m_ * position[i];
    }
    return result;
  }

  RandomRun run_;
  std::mt19937_64 random_;
  std::size_t size_;
  Phase phase_ = Phase::free;
  Numbers velocity_;
  double stiffness_N_per_m_ = 0;
};

}  // namespace

std::vector<ReferenceTick> random_ticks(const RandomRun& run) { return Generator(run).ticks(); }

}  // namespace forcebound::test
