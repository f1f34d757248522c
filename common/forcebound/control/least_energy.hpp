#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace forcebound::control {

/// The least energy that one joint of the device can have dissipated beyond what its motor put in, for all that the
/// readings tell: V(x) over the true position x, of which a reading only says that it lies in a tube.
///
///     V_n(y) = min over x of  V_{n-1}(x) + (b/h)(y - x)^2 + c |y - x| - f (y - x),     V = infinity outside the tube
///
/// A torque that is anywhere within f -+ spread, at each instant another one, costs as much as f with the friction
/// c - spread, which may be negative: then going to and fro pays, and the cost of a displacement is the convex hull of
/// this.
///
/// V is convex and piecewise quadratic. What is kept is the graph of its derivative, x as a function of p = V'(x):
/// holding a force moves each point of it to x + S(p + f, c) h/(2b) with p as it was (S the soft threshold), a reading
/// cuts it. Beyond its ends the graph goes on in straight lines: vertical (dx/dp = 0) where a tube ends, sloped once
/// time has passed. The value of V at its minimum is not kept: the members below give its changes, and the law adds
/// them up.
///
/// A graph of more than `kKnotsMax` knots is thinned so that V stays as it is next to its minimum and becomes larger
/// nowhere: an estimate from below keeps the guarantee.
///
/// Units: [m], [N], [N s/m], [J] or [rad], [N m], [N m s/rad], [J]. Real time: noexcept, no allocation, O(kKnotsMax),
/// and O(kKnotsMax^2) where the graph is thinned.
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
  void thin() noexcept;
  struct Thinning;
  [[nodiscard]] Thinning thinning(int knot) const noexcept;

  double damping_;
  double friction_;
  Graph graph_;
  double left_slope_ = 0;   // dx/dp below the first knot
  double right_slope_ = 0;  // and above the last
};

}  // namespace forcebound::control
