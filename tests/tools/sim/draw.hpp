#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>

#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

/// Numbers drawn from a seed, the same on every machine: the standard's engines are specified, its distributions are
/// not.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  /// [0, 1).
  double share() { return std::ldexp(static_cast<double>(random_() >> 11U), -53); }
  double number(double low, double high) { return low + share() * (high - low); }
  bool chance(double probability) { return share() < probability; }
  /// 0 to count - 1.
  std::uint64_t index(std::uint64_t count) { return random_() % count; }
  std::uint64_t seed() { return random_(); }
  time::Nanoseconds duration(double low_s, double high_s) { return time::from_seconds(number(low_s, high_s)); }

  template <typename Value>
  Value one_of(std::initializer_list<Value> values) {
    return *(values.begin() + index(values.size()));
  }

  /// Each component between -size and size.
  control::Vector vector(Eigen::Index rows, double size) {
    control::Vector result(rows);
    for (Eigen::Index i = 0; i < rows; ++i) result[i] = number(-size, size);
    return result;
  }

  /// Of this length, in any direction.
  control::Vector direction(Eigen::Index rows, double length) {
    control::Vector result = vector(rows, 1);
    while (result.norm() < 0.1 || result.norm() > 1) result = vector(rows, 1);
    return result * (length / result.norm());
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace forcebound::sim
