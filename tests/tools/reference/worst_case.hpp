#pragma once

#include <cstddef>
#include <vector>

#include "forcebound/control/device_facts.hpp"

/// The least energy that a joint can have dissipated beyond what its motor put in, by another way than the law's: the
/// convex conjugate, in long double, with its value and without a limit to its pieces.
namespace forcebound::test {

/// V*(p) = max over x of p x - V(x), of one joint. With phi(s) = max(|s| + spread - c, 0)^2/(4b),
///
///     a piece of time t under a force f:      V*(p) <- V*(p) + t phi(p + f)
///     a reading in [low, high]:               V*(p) <- that, but with no slope below low or above high
///     the least energy:                       min V = -V*(0)
///
/// The first is Fenchel's duality for the sum of path and piece, the second for a restriction to an interval.
class WorstCase {
 public:
  /// @param friction c >= 0
  WorstCase(long double damping, long double friction) : damping_(damping), friction_(friction) {}

  /// V = 0 in [low, high].
  void begin(long double low, long double high);

  void hold(long double force, long double spread, long double duration_s);

  /// Positions count from `by` on: next to nothing is lost where they are small.
  void move_origin(long double by);

  /// @return false, with V as it was, if no motion leads there.
  bool read(long double low, long double high);

  [[nodiscard]] long double least_J() const { return -value(0); }

  [[nodiscard]] long double reserve_J(long double force, long double spread, long double duration_s) const;

 private:
  /// a p^2 + b p + c from `from` to the next one's.
  struct Piece {
    long double from = 0;
    long double a = 0;
    long double b = 0;
    long double c = 0;

    [[nodiscard]] long double at(long double p) const { return (a * p + b) * p + c; }
    [[nodiscard]] long double slope(long double p) const { return 2 * a * p + b; }
  };

  [[nodiscard]] std::size_t place(long double p) const;
  [[nodiscard]] long double value(long double p) const { return pieces_[place(p)].at(p); }
  std::size_t cut(long double p);
  [[nodiscard]] long double where_slope_is(long double x) const;
  void add(std::size_t from, std::size_t to, const Piece& piece);

  long double damping_;
  long double friction_;
  std::vector<Piece> pieces_;  ///< the first from minus infinity
};

/// A command as it is known: of one joint.
struct KnownCommand {
  long double force = 0;
  control::Bracket begin_s{};  ///< takes effect, in the time of the stamps
  bool certain = true;         ///< false: it may never take effect, and then the one before goes on
};

/// What is known of a joint's torque for a piece of time.
struct KnownTorque {
  long double mid = 0;
  long double spread = 0;
  long double duration_s = 0;
};

/// How a device lets go of a force, counted from when it took effect.
struct KnownRelease {
  control::Bracket full_s{};
  double share = 0;
  control::Bracket part_s{};
};

/// The torques that are possible from one time to another, by trying for each time every command in turn: the k-th may
/// be in effect if it may have begun and the next certain one may not have. The first is in effect from before
/// `begin_s`.
[[nodiscard]] std::vector<KnownTorque> torques_between(const std::vector<KnownCommand>& commands,
                                                       const KnownRelease& release, long double begin_s,
                                                       long double end_s);

}  // namespace forcebound::test
