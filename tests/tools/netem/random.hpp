#pragma once

#include <cstdint>
#include <random>

namespace forcebound::netem {

/// A share of 2^32 - 1, netem's own unit for percentages: 0 is never, kCertain is always.
using Share = std::uint32_t;
inline constexpr Share kCertain = 0xffffffffU;

/// A probability, and the correlation of each draw with the one before.
struct Chance {
  Share probability = 0;
  Share correlation = 0;
  bool operator==(const Chance&) const = default;
};

/// The randomness of one direction. Only the engine comes from the standard library, since it alone is specified to
/// the bit; standard distributions differ between implementations.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform over all 32-bit values.
  std::uint32_t draw() noexcept { return static_cast<std::uint32_t>(engine_() >> 32U); }

 private:
  std::mt19937_64 engine_;
};

/// Correlated draws: next = draw (1 - c) + last c.
///
/// This is netem's exponential average. It pulls the values to the middle, so an event of 10 % that is decided by them
/// at c = 25 % happens in 1.7 % of all cases.
class CorrelatedDraw {
 public:
  CorrelatedDraw(Share correlation, Random& random) noexcept : correlation_(correlation), last_(random.draw()) {}

  std::uint32_t next(Random& random) noexcept {
    if (correlation_ == 0) return random.draw();
    const std::uint64_t c = std::uint64_t{correlation_} + 1;
    last_ = static_cast<std::uint32_t>((random.draw() * ((std::uint64_t{1} << 32U) - c) + last_ * c) >> 32U);
    return last_;
  }

 private:
  Share correlation_;
  std::uint32_t last_;
};

/// An event that happens with a given chance. One of probability 0 draws nothing.
class Event {
 public:
  Event(Chance chance, Random& random) noexcept : probability_(chance.probability), draw_(chance.correlation, random) {}

  bool happens(Random& random) noexcept { return probability_ != 0 && draw_.next(random) <= probability_; }

 private:
  Share probability_;
  CorrelatedDraw draw_;
};

}  // namespace forcebound::netem
