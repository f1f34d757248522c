#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace forcebound::test {

/// Three axes of the scene's frame: x to the user's right, y away from the user, z up [m], [N].
using Axes = std::array<double, 3>;

/// A device as a vendor's library or service has it at the other end of the cable.
///
/// It keeps the last force until another comes, or until its own watchdog releases it if it has one; gives no force
/// before `enable`; and knows nothing of who opened it. Any thread may call anything.
class StandIn {
 public:
  struct State {
    Axes position_m{};
    Axes force_N{};  ///< at the motors
    std::uint32_t buttons = 0;
    double energy_J = 0;        ///< P, the ground-truth energy balance
    double least_energy_J = 0;  ///< least P so far
  };

  StandIn() = default;
  virtual ~StandIn() = default;
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  /// Of the encoders and the rest, now; none while it is unplugged.
  [[nodiscard]] virtual std::optional<State> read() = 0;

  /// False, and nothing happens, while it is unplugged.
  virtual bool command(const Axes& force_N) = 0;

  /// Switches the motors on or off. They are off at first, and after plugging in.
  virtual bool enable(bool on) = 0;

  /// Its own watchdog: a force without a new command is released after so long; 0: never.
  virtual bool set_hold(double hold_s) = 0;

  // What a person does to it.
  virtual void plug(bool in) = 0;
  virtual void press(std::uint32_t buttons) = 0;

  /// As `read`, whether it is plugged in or not, and without a row in the recording.
  [[nodiscard]] virtual State look() = 0;
};

/// The device that the environment asks for: of another process if FORCEBOUND_STAND_IN_SOCKET names its socket (see
/// stand_in_cable.hpp), otherwise one in this process by `StandInSettings::from_environment`.
/// @throws std::runtime_error, std::invalid_argument in one line
[[nodiscard]] std::unique_ptr<StandIn> stand_in_of_environment();

}  // namespace forcebound::test
