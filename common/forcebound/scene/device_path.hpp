#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::scene {

using time::Nanoseconds;

/// Of untrusted times, which may lie further apart than 64 bits hold: wraps around.
[[nodiscard]] Nanoseconds wrapped_difference(Nanoseconds later, Nanoseconds earlier) noexcept;

/// A device's path, played evenly by the device's own clock from motions that a network delivered late, in bursts or
/// not at all.
///
/// A motion read at r_i of the device's clock arrived at a_i of the model's. Played at the time t of the model's clock
/// is the reading time p, which goes with t and approaches
///
///     t - min(M + 1 ms,  min (a_i - r_i) + 100 ms),    M = max (a_i - r_(i-1))    over the last one to two seconds
///
/// by at most a tenth of a second in each second. M is how old the newest reading was at most when the next one came,
/// so that the path at p is known; a gap that is longer than the 100 ms is an outage and does not count. Between
/// motions it is straight, also where some were lost. After the newest motion it goes on with the last velocity v,
/// which fades by v e^(-s/10 ms) as p is later by s, and is held then. Buttons are pressed and let go as the path comes
/// to the motion that says so. Where motions that come after that, or a place the device jumped to, are elsewhere, what
/// is played goes there from where it is: with a time constant of 20 ms, and at 0.6 m/s at most.
///
/// Motions are untrusted. A reading that is not later than the newest is left out. One whose a_i - r_i is more than a
/// second from the least is of another clock: the path begins anew with it. What is played stays within 100 m and
/// moves at 10 m/s at most.
///
/// Memory is fixed: 512 motions, of which a newer one replaces the oldest. Real time: noexcept, no allocation; `play`
/// is O(1) on average, O(512) at worst. Not thread-safe.
class DevicePath {
 public:
  static constexpr Nanoseconds kMargin = std::chrono::milliseconds{1};
  static constexpr Nanoseconds kDelayMost = std::chrono::milliseconds{100};
  static constexpr Nanoseconds kWindow = std::chrono::seconds{1};
  static constexpr Nanoseconds kJump = std::chrono::seconds{1};
  static constexpr std::int64_t kSlower = 10;  ///< p goes faster or slower than t by up to this part of it
  static constexpr double kGoesOn_s = 0.01;
  static constexpr double kEase_s = 0.02;
  static constexpr double kEase_m_per_s = 0.6;
  static constexpr double kFar_m = 100;
  static constexpr double kFast_m_per_s = 10;
  static constexpr std::size_t kMotions = 512;

  struct Place {
    Point position_m = Point::Zero();
    Point velocity_m_per_s = Point::Zero();
    std::uint32_t buttons = 0;  ///< as of the newest motion that was read by then
  };

  struct Motion {
    const Point& position_m;  ///< finite
    Nanoseconds read{0};      ///< by the device's clock
    Nanoseconds arrived{0};   ///< by the model's clock
    std::uint32_t buttons = 0;
  };
  void receive(const Motion& motion) noexcept;

  /// Plays on until a time of the model's clock; a time that is not later than the last one changes nothing. Before the
  /// first motion nothing is played.
  const Place& play(Nanoseconds moment) noexcept;

  void forget() noexcept {
    count_ = 0;
    placed_ = false;
  }

  /// A path that begins next goes to what its motions tell from there, as after a jump. Finite.
  void place_at(const Point& position_m) noexcept {
    place_ = {.position_m = position_m};
    placed_ = true;
  }

  [[nodiscard]] bool begun() const noexcept { return count_ > 0; }

  /// How long before a time of the device's clock the reading time played is; below zero: after it. At most a second
  /// either way.
  [[nodiscard]] Nanoseconds played_before(Nanoseconds device_time) const noexcept;

 private:
  struct Knot {
    Nanoseconds read{0};  ///< since `epoch_`
    Point position_m = Point::Zero();
    Point velocity_m_per_s = Point::Zero();  ///< mean since the motion before
    std::uint32_t buttons = 0;
  };

  /// The least of a_i - r_i, and M.
  struct Transits {
    Nanoseconds least = Nanoseconds::max();
    Nanoseconds most = Nanoseconds::min();

    void add(const Transits& other) noexcept;
  };

  void begin(const Motion& motion, const Point& position_m) noexcept;
  void add(const Knot& newest) noexcept;
  void add_transit(const Transits& one, Nanoseconds arrived) noexcept;
  void advance(Nanoseconds elapsed) noexcept;
  void ease(double elapsed_s) noexcept;
  void bound_speed(const Point& before_m, double elapsed_s) noexcept;
  [[nodiscard]] Transits transits() const noexcept;
  [[nodiscard]] const Knot& knot(std::size_t i) const noexcept { return knots_[(first_ + i) % kMotions]; }
  [[nodiscard]] Place reported_at(Nanoseconds reading) const noexcept;

  std::array<Knot, kMotions> knots_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  Nanoseconds epoch_{0};  // of the device's clock: the reading with which the path began
  Transits now_{};
  Transits before_{};  // of the window before
  Nanoseconds window_began_{0};
  Nanoseconds played_{0};     // p, since `epoch_`
  Nanoseconds played_at_{0};  // t
  Place place_{};
  bool placed_ = false;
  Point aside_m_ = Point::Zero();  // what is played, less what the motions tell of
};

}  // namespace forcebound::scene
