#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace forcebound::control {

/// The least energy that one joint of the device can have dissipated beyond what its motor put in, for all that the
/// readings tell: V(x) over the true position x, of which a reading only says that it lies in a tube.
///
///     a piece of time:   V(y) <- min over x of  V(x) + g(y - x; f, k, t),     y anywhere
///     a reading:         V = infinity outside the tube
///     g(d; f, k, t) = the convex hull in d of  (b/t) d^2 + (c - k) |d| - f d
///
/// for a torque that is anywhere within f -+ k, at each instant another one, for a time of at most t. Where k > c,
/// going to and fro pays, and g is flat about d = 0.
///
/// V is convex and piecewise quadratic. What is kept is the graph of its derivative, x as a function of p = V'(x):
/// holding a force moves each point of it to x + S(p + f, c - k) t/(2b) with p as it was (S the soft threshold), a
/// reading cuts it. Beyond its ends the graph goes on in straight lines: vertical (dx/dp = 0) where a tube ends, sloped
/// once time has passed. The value of V at its minimum is not kept: the members below give its changes, and the law
/// adds them up.
///
/// Of more than `kKnotsMax` knots some are merged, so that V stays as it is next to its minimum and becomes larger
/// nowhere: an estimate from below keeps the guarantee.
///
/// Units: [m], [N], [N s/m], [J] or [rad], [N m], [N m s/rad], [J]. Real time: noexcept, no allocation, O(kKnotsMax),
/// and O(kKnotsMax^2) where knots are merged.
class LeastEnergy {
 public:
  static constexpr int kKnotsMax = 32;

  /// The position lies between two bounds; equal for an ideal encoder.
  struct Tube {
    double low = 0;
    double high = 0;
  };

  /// @param damping b > 0 and friction c >= 0: what the joint has at the least.
  LeastEnergy(double damping, double friction) noexcept : damping_(damping), friction_(friction) {}

  /// V = 0 in the tube: nothing is known of what went before.
  void restart(const Tube& tube) noexcept;

  /// Lets a force within `force` -+ `spread` act for a time >= 0 [s], to whatever position it may lead. Gives the
  /// change of the minimum [J], <= 0: -`reserve_J`.
  double hold(double force, double spread, double duration_s) noexcept;

  /// Cuts V to the tube of a new reading. Gives the change of the minimum [J], >= 0, or nothing if no finite motion
  /// leads there; V is then as it was.
  [[nodiscard]] std::optional<double> read(const Tube& tube) noexcept;

  /// max(|f| + spread - c, 0)^2 t/(4b) [J]: the most that holding the force for t [s] can return beyond what the joint
  /// dissipates.
  [[nodiscard]] double reserve_J(double force, double spread, double duration_s) const noexcept;

  [[nodiscard]] int knots() const noexcept { return graph_.count; }

  /// Whether knots were ever merged: since then V may be less than the least energy.
  [[nodiscard]] bool merged() const noexcept { return merged_; }

  [[nodiscard]] double damping() const noexcept { return damping_; }
  [[nodiscard]] double friction() const noexcept { return friction_; }

 private:
  struct Knot {
    double x = 0;
    double p = 0;
  };
  /// A graph with room for what a tick adds to a full one.
  struct Graph {
    static constexpr int kRoom = kKnotsMax + 12;
    std::array<Knot, kRoom> knots{};  // sorted by p, and by x
    int count = 0;

    Knot& operator[](int i) noexcept { return knots[static_cast<std::size_t>(i)]; }
    const Knot& operator[](int i) const noexcept { return knots[static_cast<std::size_t>(i)]; }
    void push(const Knot& knot) noexcept { knots[static_cast<std::size_t>(count++)] = knot; }
    void insert(int i, const Knot& knot) noexcept;
    void erase(int i) noexcept;
  };

  /// The point of the straight line from `a` up to `b` at position x.
  static Knot crossing(const Knot& a, const Knot& b, double x) noexcept;
  /// Integral of max(p, 0) dx along it.
  static double work_above_zero(const Knot& a, const Knot& b) noexcept;
  static Knot mirrored(const Knot& knot) noexcept { return {-knot.x, -knot.p}; }

  int insert(double p) noexcept;
  void split(double p, double reach) noexcept;
  [[nodiscard]] Graph extended(const Tube& tube) const noexcept;
  void merge_knots() noexcept;
  struct Merge;
  [[nodiscard]] Merge merge_of(int knot) const noexcept;

  double damping_;
  double friction_;
  bool merged_ = false;
  Graph graph_;
  double left_slope_ = 0;   // dx/dp below the first knot
  double right_slope_ = 0;  // and above the last
};

}  // namespace forcebound::control
