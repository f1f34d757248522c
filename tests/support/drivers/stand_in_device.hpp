#pragma once

#include <condition_variable>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/drivers/stand_in.hpp"

namespace forcebound::test {

struct StandInSettings {
  /// Three axes, 0.2 kg, 4 N s/m, encoder step 10 um. With another: of three degrees of freedom.
  device::DeviceDescription device = usual_device();
  std::string hand{};     ///< that moves it, as for --operator; empty: nobody holds it
  double hold_s = 0;      ///< of its own watchdog; 0: it has none
  std::string log{};      ///< file of the recording; empty: none
  std::string control{};  ///< FIFO of commands, see `StandInDevice::obey`; empty: none

  /// FORCEBOUND_STAND_IN_DEVICE (a name or file as of --device), _HAND, _HOLD_S, _LOG, _CONTROL.
  [[nodiscard]] static StandInSettings from_environment();

  [[nodiscard]] static device::DeviceDescription usual_device();
};

/// The simulated device of forcebound::device, run by the real clock: exact motion, exact audit. A thread of its own
/// runs it on while nobody calls, so that its watchdog releases a force when it is due. Device and hand begin to move
/// when the motors are switched on for the first time.
///
/// The recording is a CSV file with a row for each call and event, written at once so that it is whole whenever the
/// process ends: time_s (of CLOCK_MONOTONIC), event, x_m, y_m, z_m, force_x_N, force_y_N, force_z_N, energy_J,
/// least_energy_J. The force is the one at the motors from then on. Events: start, read, command, enable, disable,
/// release (by the watchdog, at the time when it was due), unplug, plug, press, mark, end.
class StandInDevice final : public StandIn {
 public:
  /// @throws std::runtime_error, std::invalid_argument in one line
  explicit StandInDevice(StandInSettings settings);
  ~StandInDevice() override;

  [[nodiscard]] std::optional<State> read() override;
  bool command(const Axes& force_N) override;
  bool enable(bool on) override;
  bool set_hold(double hold_s) override;
  void plug(bool in) override;
  void press(std::uint32_t buttons) override;
  [[nodiscard]] State look() override;

  /// What a line of the control FIFO says: `unplug`, `plug`, `press MASK`, `hold SECONDS`, `mark`, which is but a row.
  /// False: none of these.
  bool obey(std::string_view line);

 private:
  [[nodiscard]] time::Nanoseconds advance();
  void store_position(const device::Vector& tip);
  void push(time::Nanoseconds now, const Axes& force_N);
  void write_row(time::Nanoseconds at, const char* event);
  [[nodiscard]] State state() const;
  void run();
  void read_control();

  std::mutex guard_;
  std::condition_variable ends_;
  time::SteadyClock clock_;
  device::SimulatedDevice device_;
  Axes position_m_{};
  Axes force_N_{};
  std::uint32_t buttons_ = 0;
  bool plugged_ = true;
  bool enabled_ = false;
  bool begun_ = false;
  bool ending_ = false;
  time::Nanoseconds hold_{0};
  time::Nanoseconds commanded_{0};
  std::FILE* log_ = nullptr;
  int control_ = -1;
  std::string heard_;
  std::thread thread_;
};

}  // namespace forcebound::test
