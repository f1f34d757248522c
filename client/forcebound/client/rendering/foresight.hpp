#pragma once

#include <cstddef>

#include "forcebound/local_model/local_model.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/tick_ring.hpp"

namespace forcebound::client {

using local_model::Point;
using time::Nanoseconds;

/// Whether models foretell the server's force better than holding its newest one does: local rendering is to be no
/// worse than remote rendering.
///
/// Each answer tells the force at a time for which both had been said on some tick. Of the errors of both, the RMS over
/// about the last kForget_s counts: models count wholly while theirs is at most half of that of holding, less and less
/// beyond, and not at all where they are no better. An error of kAgrees_N of holding is none: at rest both are right.
///
/// Real time: noexcept, no allocation; looks back through at most kTicks ticks for each answer.
class Foresight {
 public:
  static constexpr double kForget_s = 0.3;
  static constexpr double kAgrees_N = 0.05;

  /// What was said on a tick.
  struct Tick {
    Nanoseconds time{0};
    bool modelled = false;             ///< some model held there: others are not compared
    Point modelled_N = Point::Zero();  ///< what models asked for
    Point held_N = Point::Zero();
  };

  void remember(const Tick& tick) noexcept { ticks_.push(tick); }

  /// An answer tells what the force was then.
  void compare(Nanoseconds then, const Point& told_N) noexcept;

  /// The share of the models that counts, from 0 to 1; 1 before anything was compared.
  [[nodiscard]] double trust() const noexcept { return trust_; }

 private:
  static constexpr std::size_t kTicks = 512;

  time::TickRing<Tick, kTicks> ticks_;
  Nanoseconds compared_{0};  // the newest time of which an answer told
  double modelled_N2_ = 0;
  double held_N2_ = 0;
  double trust_ = 1;
};

}  // namespace forcebound::client
