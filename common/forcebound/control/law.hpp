#pragma once

#include <limits>
#include <string_view>

#include "forcebound/control/damping.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// Whether a clock can have measured this time between two readings: a nanosecond, which is what clocks count, to
/// eleven days.
[[nodiscard]] constexpr bool is_measurable(double interval_s) noexcept {
  return interval_s >= 1e-9 && interval_s <= 1e6;
}

/// Which stamps of readings can be believed. One that ends an interval that is not measurable cannot, and so neither
/// can the interval from it to the next one, whatever the clock says (proof, A10). No interval ends at the first
/// stamp.
class StampCheck {
 public:
  /// With each reading, lost ones too.
  void pass(double interval_s) noexcept {
    const bool possible = !begun_ || is_measurable(interval_s);
    interval_believed_ = possible && stamp_believed_;
    stamp_believed_ = possible;
    begun_ = true;
  }

  /// The newest stamp.
  [[nodiscard]] bool stamp_believed() const noexcept { return stamp_believed_; }

  /// Both stamps of the interval that ended last.
  [[nodiscard]] bool interval_believed() const noexcept { return interval_believed_; }

 private:
  bool begun_ = false;
  bool stamp_believed_ = true;
  bool interval_believed_ = true;
};

/// What a tick measured before it chooses a force. All vectors finite, `dof` rows.
struct Motion {
  double interval_s = 0;  ///< measured length of the interval that ended with this reading (h_n), 0 at first
  double latency_s = 0;   ///< from the previous reading to the effect of the force chosen on it, by the facts (delta_n)
  double effect_s = std::numeric_limits<double>::quiet_NaN();  ///< the same as the device reports it, if it does
  double held_s = std::numeric_limits<double>::infinity();     ///< from `latency_s` until the device let go, if it did
  bool write_failed = false;  ///< whether the force was ever in effect, or the one before it still is, is unknown
  double latency_s_max = 0;   ///< the longest that the force now to be chosen may take from this reading to its effect
  /// Task space [m], device frame. Where the tip turns, below that the sum of the rotation vectors of all intervals,
  /// each about the pose at its beginning [rad]: its differences alone mean something.
  Vector position;
  Vector joint;     ///< joint readings; equal to `position` for a Cartesian device
  Matrix jacobian;  ///< of the tip's velocity, and of its angular velocity where it turns, at this reading
  const Damping* damping = nullptr;  ///< task-space damping at this reading; holds for the interval that begins here
};

/// Numbers of the server-side law: what it and the law at the device tell each other, such as cumulative sums, set
/// positions and gains. At most 16, no heap.
using ServerLawNumbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 16, 1>;

/// Turns what the environment asks for into the force on the device. Force bounding keeps the device from returning
/// more energy than its own damping takes; what a law promises of that, and on which device, is its LawClaim.
///
/// Sign: `f` [N] is the force **on the device**, the way haptics APIs mean it; a wall at x >= 0 gives f = -K x. The
/// paper [Kim, Baek, Ryu 2015] writes F_d = -f, so its `+F dx` is our `-f'd`.
///
/// A tick calls, in this order: `credit` with the motion since the last one, `bound` with what the environment asks
/// for, `commit` with what the device was really told after rounding. A lost reading is `lose`, then `commit` of zero.
/// ForceBounder does that; laws hold no policy of their own for saturation, rounding or faulty input.
///
/// A law with a server-side law (ServerSideLaw) names it by `server_law`. What goes out with each motion is `outgoing`,
/// what comes with each force that is newer than all before is `incoming`, ahead of that tick's `credit`.
/// Datagrams are lost, doubled and reordered, so what must not be lost or counted twice travels as a sum since the
/// beginning.
///
/// Real time: every member is noexcept, allocates nothing and is O(dof^3) at most. Not thread-safe; owned by the tick.
class PassivityLaw {
 public:
  virtual ~PassivityLaw() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;

  /// Notes the motion under the force committed last. An interval that is not measurable credits nothing. Where the
  /// device let go of that force before this reading (`held_s`), a law that cannot tell where the device was at that
  /// time credits nothing and charges the force its worst case.
  virtual void credit(const Motion& motion) noexcept = 0;

  /// The reading was lost: nothing can be credited, and the force committed last is charged its worst case. Of `motion`
  /// only the times may be used.
  virtual void lose(const Motion& motion) noexcept = 0;

  /// The force that the law makes of `request_N`; of a law that only bounds, the nearest that it allows now. Once a
  /// tick. It need not keep to what the device can be asked for: ForceBounder shortens it, and commits that.
  [[nodiscard]] virtual Vector bound(const Vector& request_N) noexcept = 0;

  /// Whether this very force, say after rounding, is allowed now, if it takes effect `latency_s` after the reading. A
  /// law that says nothing of it takes what rounding and lateness make of its force.
  [[nodiscard]] virtual bool allows(const Vector& force_N, double latency_s) const noexcept {
    (void)force_N, (void)latency_s;
    return true;
  }

  /// What the device was told, and holds until the next tick.
  virtual void commit(const Vector& force_N) noexcept = 0;

  /// Energy that the law may spend now [J].
  [[nodiscard]] virtual double energy_J() const noexcept = 0;

  /// Share of the coming interval's dissipation that the law will credit (the paper's xi), 0 to 1.
  [[nodiscard]] virtual double xi() const noexcept { return 1.0; }

  /// Where the environment is asked [m]: at the device, unless the law keeps a tool of its own between the two.
  [[nodiscard]] virtual Vector proxy_position(const Vector& position) const noexcept { return position; }

  /// The name of the server-side law that it needs; empty: none.
  [[nodiscard]] virtual std::string_view server_law() const noexcept { return {}; }

  /// Energy that the law has given up since the beginning, for a follower to spend [J]: never falls, and P less this
  /// stays above zero. Of a law that gives nothing up, 0.
  [[nodiscard]] virtual double energy_given_J() const noexcept { return 0; }

  /// Energy [J] >= 0 that a law elsewhere gave up: this one may spend it as if its own device had dissipated it. A law
  /// that keeps no account of energy ignores it.
  virtual void receive_energy(double energy_J) noexcept { (void)energy_J; }

  /// For the server-side law, as of the tick before.
  [[nodiscard]] virtual ServerLawNumbers outgoing() const noexcept { return {}; }

  /// From the server-side law; any finite numbers, of any count.
  virtual void incoming(const ServerLawNumbers& numbers) noexcept { (void)numbers; }

  /// Another server-side law, whose sums begin at zero.
  virtual void begin_server_side() noexcept {}
};

}  // namespace forcebound::control
