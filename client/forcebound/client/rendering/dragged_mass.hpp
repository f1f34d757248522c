#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "forcebound/client/rendering/device_point.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// Renders a local_model::Mass: moves it under the device's own force, at the device's own rate.
///
/// Where it is belongs to the client. An answer says where it was at some time before; the client knows where it had it
/// then, and goes on from where it has it now. Only if both differ by more than 0.2 mm does it move there, slowly: the
/// difference is that of a model which neglects something, not of a blow. So it does where an answer's travel limit is
/// behind it, and meanwhile goes no farther. Of more than 20 mm, or after an answer that said nothing of it, it begins
/// anew where the answer says.
///
/// Real time: noexcept, no allocation; at most 100 steps of a millisecond a tick.
class DraggedMass {
 public:
  /// Below it, both agree [m].
  static constexpr double kAgrees_m = 2e-4;
  /// Beyond its limit by less, it is within [m]: a coupling of 1 N/mm pushes by 0.02 N more.
  static constexpr double kWithin_m = 2e-5;
  /// Of a correction.
  static constexpr double kCorrection_m_per_s = 0.02;
  static constexpr double kCorrection_s = 0.1;
  static constexpr double kBeginsAnew_m = 0.02;

  /// Another answer tells of it. @param now of the device's clock
  void update(const local_model::Mass& told, const ModelAge& age, Nanoseconds now) noexcept;

  void forget() noexcept { there_ = false; }

  /// Moves it for the time since the last tick, in which the device came straight from where it was.
  /// @param share of what else pulls at it: less than 1 when the server does not say so any more
  void advance(const DevicePoint& device, double elapsed_s, Nanoseconds now, double share = 1) noexcept;

  /// Force on the device: what moved the mass on this tick, as at the server.
  [[nodiscard]] Point force_N(const DevicePoint& device) const noexcept {
    return moved_ ? Point(-moved_by_N_) : Point(-pull_N(device));
  }
  [[nodiscard]] double weight(const DevicePoint& device) const noexcept {
    return weight_at((device.place_m - reported_.place_m).norm(), reported_.radius_m);
  }
  [[nodiscard]] const Point& held_N() const noexcept { return reported_.force_N; }

  /// Nobody else moves it: when the server is silent, the client knows where it is.
  [[nodiscard]] bool is_the_devices_own() const noexcept { return !reported_.others_move_it; }

  /// Nothing but the device pulls at it.
  [[nodiscard]] bool stands() const noexcept { return is_the_devices_own() && reported_.bias_m_per_s2.isZero(0); }

  [[nodiscard]] const Point& place_m() const noexcept { return place_m_; }

  /// How far it is from where the newest answer had it at that time, or within its limit, less what was corrected since
  /// [m].
  [[nodiscard]] double deviation_m() const noexcept { return there_ ? deviation_m_.norm() : 0; }

 private:
  struct Past {
    Nanoseconds time{0};
    Point place_m = Point::Zero();  // less all corrections until then
  };

  static constexpr std::size_t kPasts = 2048;

  [[nodiscard]] Point pull_N(const DevicePoint& device) const noexcept;
  [[nodiscard]] std::optional<Point> place_at_m(Nanoseconds time) const noexcept;
  void begin(const ModelAge& age) noexcept;
  void find_way_back() noexcept;
  void match_held_velocity() noexcept;
  /// How far along the push from where it was told to be; zero without a push.
  [[nodiscard]] double way_m() const noexcept;
  void stop_at(double most_m) noexcept;
  void step(const DevicePoint& device, double step_s, double share) noexcept;
  void correct(double elapsed_s) noexcept;
  void remember(Nanoseconds now) noexcept;

  local_model::Mass reported_{};
  Point back_ = Point::Zero();  // against which it comes back within its limit, 1 long along the push; or no push
  bool there_ = false;
  Point place_m_ = Point::Zero();
  Point velocity_m_per_s_ = Point::Zero();
  DevicePoint device_{};               // in the last step
  Point moved_by_N_ = Point::Zero();   // by the coupling, in that step
  bool moved_ = false;                 // since it began
  Point corrected_m_ = Point::Zero();  // in all
  Point deviation_m_ = Point::Zero();  // still to be corrected
  std::array<Past, kPasts> past_{};
  std::size_t past_count_ = 0;  // of all that were remembered
};

}  // namespace forcebound::client
