#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <optional>

#include "forcebound/control/enum_array.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/device/safety.hpp"

namespace forcebound::client {

using control::Vector;

/// Bounds the force that is asked of the law by a device's Safety:
///
///     asked = ramp(t) fade(x) believed F, its length at most cap
///     asked = 0    while the tip is too fast, the handle turns too fast, readings are frozen or the dead-man button
///                  is up
///
/// ramp goes from 0 to 1 in ramp_s, from the first usable reading after start, after one that was not, after the hand
/// was too fast or readings were frozen, or from when the dead-man button was pressed. A device without that button has
/// it up. fade goes from 1
/// at workspace_radius_m to 0 at workspace_fade_m beyond; believed is the share that UnseenEnergy leaves. cap is no
/// limit while the mean square of the force that was applied, over rms_s, is below rms_force_N_max^2; above, it falls
/// to rms_force_N_max by as much in each second, and rises likewise once the mean square is 10 % below.
///
/// While it grows the length is at most ramp force_N_max. Readings that are missing for less than 20 ms begin no ramp.
///
/// A torque has a share of its own: the same ramp and fade, and a cap by its own mean square and rms_torque_N_m_max.
///
/// A speed is that between readings, smoothed over 5 ms, so that one jump of an encoder trips nothing. Too fast, the
/// hand must become half as fast.
///
/// Real time: noexcept, no allocation, O(dof). Deterministic.
class HandSafety {
 public:
  enum class Trip : std::uint8_t { speed, turn, workspace, heat, dead_man, frozen };

  /// @param force_N_max the device's largest, as the torque
  explicit HandSafety(const device::Safety& limits, double force_N_max = std::numeric_limits<double>::infinity(),
                      double torque_N_m_max = std::numeric_limits<double>::infinity()) noexcept
      : limits_(limits),
        speed_{.most_per_s = limits.speed_m_per_s_max},
        turn_{.most_per_s = limits.turn_rad_per_s_max},
        force_N_max_(force_N_max),
        torque_N_m_max_(torque_N_m_max) {}

  struct Tick {
    const Vector& position;   ///< [m]; not finite: there is no usable reading
    const Vector& applied_N;  ///< since the last tick
    double elapsed_s = 0;     ///< since the last reading
    control::Handle handle{};
    Eigen::Vector3d applied_N_m = Eigen::Vector3d::Zero();  ///< torque since the last tick
    double believed = 1;                                    ///< of UnseenEnergy
    bool frozen = false;                                    ///< likewise
  };
  /// @param wanted_N of the rendering @returns what may be asked of the law
  [[nodiscard]] Vector limited(const Vector& wanted_N, const Tick& tick) noexcept;

  /// After `limited` on the same tick: what may be asked of the law of a torque [N m].
  [[nodiscard]] Eigen::Vector3d limited_torque(const Eigen::Vector3d& wanted_N_m) const noexcept;

  /// The limit that began to act since the last call, to tell the user.
  [[nodiscard]] std::optional<Trip> take_trip() noexcept;

  /// How often each began to act.
  [[nodiscard]] std::uint64_t trips(Trip which) const noexcept { return trips_[which]; }

  [[nodiscard]] const device::Safety& limits() const noexcept { return limits_; }

 private:
  /// How fast the hand is on its way [m] or in its turn [rad].
  struct Speed {
    double most_per_s = 0;  ///< 0: no limit
    double mean_per_s = 0;
    bool too_fast = false;
  };
  void update_speeds(const Tick& tick, double elapsed_s) noexcept;
  /// @param speed that has a limit @returns whether it has become too fast just now
  [[nodiscard]] static bool update_speed(Speed& speed, double way, double elapsed_s) noexcept;
  void forget_speeds() noexcept;
  /// The load of motors, by their force or torque, and the cap that it makes.
  struct Load {
    double mean_square = 0;
    bool hot = false;
    double cap = std::numeric_limits<double>::infinity();
  };
  /// @param most of the root mean square @returns whether it has become too hot just now
  [[nodiscard]] bool update_load(Load& load, double applied, double most, double elapsed_s) const noexcept;
  void update_button(const Tick& tick) noexcept;
  [[nodiscard]] double fade(const Vector& position) noexcept;
  void begin(Trip which) noexcept;

  device::Safety limits_;
  std::optional<Vector> last_position_{};
  std::optional<Eigen::Quaterniond> last_orientation_{};
  Speed speed_;
  Speed turn_;
  bool let_go_ = false;  ///< of the dead-man button
  bool frozen_ = false;  ///< readings
  double ramp_ = 0;
  bool outside_ = false;
  double share_ = 0;  ///< ramp, fade and what is believed of this tick
  Load force_load_{};
  Load torque_load_{};
  std::optional<Trip> newest_{};
  control::EnumArray<Trip, std::uint64_t, 6> trips_{};
  double force_N_max_;
  double torque_N_m_max_;
  double missing_s_ = 0;  ///< without a usable reading
};

}  // namespace forcebound::client
