#pragma once

#include <cstddef>

#include "forcebound/local_model/device_point.hpp"
#include "forcebound/local_model/mass_step.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/tick_ring.hpp"

namespace forcebound::local_model {

using time::Nanoseconds;

/// Renders a Mass: moves it under the device's own force, at the device's own rate.
///
/// An answer says where the mass was at some time before. Since then the device has gone a way that the client knows
/// and the server does not: an answer's mass is moved along that way again until it has caught up with the present one,
/// and takes its place. So nothing that a model neglects lasts for longer than an answer is old. While one catches up,
/// later answers are passed over. Through what the ring of ticks does not tell of, the mass goes straight on.
///
/// Real time: noexcept, no allocation; at most `catch_up` steps of a millisecond for an answer and on each tick, beside
/// the tick's own.
class DraggedMass {
 public:
  static constexpr int kCatchUp = 48;

  explicit DraggedMass(int catch_up = kCatchUp) noexcept : most_(catch_up) {}

  /// Another answer tells of it. @param now of the device's clock
  void update(const Mass& told, const ModelAge& age, Nanoseconds now) noexcept;

  void forget() noexcept { there_ = coming_ = false; }

  /// Moves it for the time since the last tick, in which the device came straight from where it was.
  /// @param share of what else pulls at it: less than 1 when the server does not say so any more
  void advance(const DevicePoint& device, double elapsed_s, Nanoseconds now, double share = 1) noexcept;

  /// An answer's mass has caught up: what it changes at once is for the caller to fade.
  [[nodiscard]] bool has_caught_up() const noexcept { return coming_ && reached_ == now_; }
  void take_its_place() noexcept;

  /// On the device, by the coupling.
  [[nodiscard]] Point force_N(const DevicePoint& device) const noexcept { return -pull_N(reported_, state_, device); }
  [[nodiscard]] double weight(const DevicePoint& device) const noexcept {
    return there_ ? weight_at((device.place_m - reported_.place_m).norm(), reported_.radius_m) : 0;
  }
  /// Of it in the newest answer.
  [[nodiscard]] const Point& held_N() const noexcept { return newest_N_; }

  /// Nobody else moves it: when the server is silent, the client knows where it is.
  [[nodiscard]] bool is_the_devices_own() const noexcept { return there_ && !reported_.others_move_it; }

  /// Nothing but the device pulls at it or at what it meets.
  [[nodiscard]] bool stands() const noexcept;

  [[nodiscard]] const Point& place_m() const noexcept { return state_.place_m; }
  /// With what it meets.
  [[nodiscard]] const MassState& state() const noexcept { return state_; }

  /// How far the last answer that took its place moved it [m]: what the models before had not foreseen.
  [[nodiscard]] double deviation_m() const noexcept { return there_ ? deviation_m_ : 0; }

 private:
  struct Tick {
    Nanoseconds time{0};
    DevicePoint device{};
    double elapsed_s = 0;  // since the tick before
    double share = 1;
  };

  static constexpr std::size_t kTicks = 512;

  void catch_up() noexcept;

  int most_;
  Point newest_N_ = Point::Zero();
  bool there_ = false;
  Mass reported_{};
  MassState state_{};
  // The mass of a later answer, and until when it has been moved.
  bool coming_ = false;
  Mass later_{};
  MassState later_state_{};
  Nanoseconds reached_{0};
  Nanoseconds now_{0};
  double deviation_m_ = 0;
  time::TickRing<Tick, kTicks> ticks_;
};

}  // namespace forcebound::local_model
