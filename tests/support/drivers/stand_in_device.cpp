#include "tests/support/drivers/stand_in_device.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"

namespace forcebound::test {
namespace {

using time::Nanoseconds;
using namespace std::chrono_literals;

constexpr int kAxes = 3;

/// Nobody: no mass, no spring, no damper.
class NoHand final : public device::Operator {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "none"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return kAxes; }
  [[nodiscard]] Target target(double /*time_s*/) const noexcept override {
    return {device::Vector::Zero(kAxes), device::Vector::Zero(kAxes)};
  }
  [[nodiscard]] std::string description() const override { return "nobody holds it"; }

 private:
  device::Hand hand_{};
};

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : value;
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The watchdog is ours, because it can be set while the device runs.
device::DeviceDescription without_watchdog(device::DeviceDescription device) {
  if (device.facts.degrees_of_freedom() != kAxes) {
    throw std::invalid_argument("stand-in: device '" + device.facts.name + "' must have 3 degrees of freedom");
  }
  device.facts.releases = false;
  return device;
}

std::unique_ptr<const device::Operator> hand_of(const std::string& hand) {
  if (hand.empty()) return std::make_unique<NoHand>();
  return device::make_operator(hand, kAxes);
}

}  // namespace

device::DeviceDescription StandInSettings::usual_device() {
  constexpr double kMass_kg = 0.2;
  constexpr double kDamping_N_s_per_m = 4;
  constexpr double kEncoderStep_m = 1e-5;
  device::DeviceDescription device;
  device.facts.name = "stand-in";
  device.facts.damping = kDamping_N_s_per_m * device::Matrix::Identity(kAxes, kAxes);
  device.facts.friction = device::Vector::Zero(kAxes);
  device.facts.encoder_step = device::Vector::Constant(kAxes, kEncoderStep_m);
  device.facts.actuator_step = device::Vector::Zero(kAxes);
  device.facts.force_N_max = 100;
  device.inertia = kMass_kg * device::Matrix::Identity(kAxes, kAxes);
  return device;
}

StandInSettings StandInSettings::from_environment() {
  StandInSettings settings;
  const std::string device = variable("FORCEBOUND_STAND_IN_DEVICE");
  if (!device.empty()) settings.device = device::load_device(device);
  settings.hand = variable("FORCEBOUND_STAND_IN_HAND");
  settings.log = variable("FORCEBOUND_STAND_IN_LOG");
  settings.control = variable("FORCEBOUND_STAND_IN_CONTROL");
  const std::string hold = variable("FORCEBOUND_STAND_IN_HOLD_S");
  if (hold.empty()) return settings;
  const std::optional<double> hold_s = number(hold);
  if (!hold_s || *hold_s < 0) {
    throw std::invalid_argument("FORCEBOUND_STAND_IN_HOLD_S must be a number of seconds >= 0, got '" + hold + "'");
  }
  settings.hold_s = *hold_s;
  return settings;
}

StandInDevice::StandInDevice(StandInSettings settings)
    : device_(without_watchdog(std::move(settings.device)), hand_of(settings.hand)),
      hold_(time::from_seconds(settings.hold_s)) {
  if (!settings.log.empty()) {
    log_ = std::fopen(settings.log.c_str(), "we");
    if (log_ == nullptr) throw std::runtime_error(settings.log + ": " + std::strerror(errno));
    std::setvbuf(log_, nullptr, _IOLBF, BUFSIZ);
    std::fputs("time_s,event,x_m,y_m,z_m,force_x_N,force_y_N,force_z_N,energy_J,least_energy_J\n", log_);
  }
  if (!settings.control.empty()) {
    // For writing too: a FIFO without a writer would end at once.
    control_ = ::open(settings.control.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (control_ < 0) throw std::runtime_error(settings.control + ": " + std::strerror(errno));
  }
  store_position(device_.truth().position);
  write_row(advance(), "start");
  thread_ = std::thread([this] { run(); });
}

StandInDevice::~StandInDevice() {
  {
    const std::scoped_lock lock(guard_);
    ending_ = true;
  }
  ends_.notify_all();
  thread_.join();
  write_row(advance(), "end");
  if (log_ != nullptr) std::fclose(log_);
  if (control_ >= 0) ::close(control_);
}

std::optional<StandIn::State> StandInDevice::read() {
  const std::scoped_lock lock(guard_);
  const Nanoseconds now = advance();
  if (!plugged_) return std::nullopt;
  write_row(now, "read");
  return state();
}

bool StandInDevice::command(const Axes& force_N) {
  const std::scoped_lock lock(guard_);
  const Nanoseconds now = advance();
  if (!plugged_) return false;
  commanded_ = now;
  push(now, enabled_ ? force_N : Axes{});
  write_row(now, "command");
  return true;
}

bool StandInDevice::enable(bool on) {
  const std::scoped_lock lock(guard_);
  const Nanoseconds now = advance();
  if (!plugged_) return false;
  begun_ = begun_ || on;
  enabled_ = on;
  push(now, {});
  write_row(now, on ? "enable" : "disable");
  return true;
}

bool StandInDevice::set_hold(double hold_s) {
  const std::scoped_lock lock(guard_);
  (void)advance();
  if (!plugged_) return false;
  hold_ = time::from_seconds(hold_s);
  return true;
}

void StandInDevice::plug(bool in) {
  const std::scoped_lock lock(guard_);
  const Nanoseconds now = advance();
  if (in == plugged_) return;
  plugged_ = in;
  enabled_ = false;
  push(now, {});
  write_row(now, in ? "plug" : "unplug");
}

void StandInDevice::press(std::uint32_t buttons) {
  const std::scoped_lock lock(guard_);
  buttons_ = buttons;
  write_row(advance(), "press");
}

StandIn::State StandInDevice::look() {
  const std::scoped_lock lock(guard_);
  (void)advance();
  return state();
}

bool StandInDevice::obey(std::string_view line) {
  const std::string_view word = line.substr(0, line.find(' '));
  const std::optional<double> value = number(line.substr(std::min(line.size(), word.size() + 1)));
  if (word == "unplug" || word == "plug") {
    plug(word == "plug");
  } else if (word == "press" && value && *value >= 0) {
    press(static_cast<std::uint32_t>(*value));
  } else if (word == "mark") {
    const std::scoped_lock lock(guard_);
    write_row(advance(), "mark");
  } else if (word == "hold" && value && *value >= 0) {
    set_hold(*value);
  } else {
    return false;
  }
  return true;
}

/// Runs the device up to now. A force that the watchdog releases on the way ends when that was due, however late the
/// thread is. `guard_` is held.
Nanoseconds StandInDevice::advance() {
  const Nanoseconds now = clock_.now();
  if (!begun_) return now;
  const bool holds = hold_ > 0ns && force_N_ != Axes{};
  const Nanoseconds due = commanded_ + hold_;
  if (holds && due <= now) {
    push(due, {});
    write_row(due, "release");
  }
  store_position(device_.read(now).position);
  return now;
}

void StandInDevice::store_position(const device::Vector& tip) {
  for (int axis = 0; axis < kAxes; ++axis) position_m_[static_cast<std::size_t>(axis)] = tip[axis];
}

void StandInDevice::push(Nanoseconds now, const Axes& force_N) {
  force_N_ = force_N;
  if (begun_) device_.apply(now, Eigen::Map<const Eigen::Vector3d>(force_N.data()));
}

StandIn::State StandInDevice::state() const {
  const control::PassivityAudit audit = *device_.audit();
  return {.position_m = position_m_,
          .force_N = force_N_,
          .buttons = buttons_,
          .energy_J = audit.energy_J,
          .least_energy_J = audit.minimum_J};
}

void StandInDevice::write_row(Nanoseconds at, const char* event) {
  if (log_ == nullptr) return;
  const State now = state();
  std::fprintf(log_, "%.9f,%s,%.7g,%.7g,%.7g,%.9g,%.9g,%.9g,%.6g,%.6g\n", time::to_seconds(at), event,
               now.position_m[0], now.position_m[1], now.position_m[2], now.force_N[0], now.force_N[1], now.force_N[2],
               now.energy_J, now.least_energy_J);
}

void StandInDevice::run() {
  std::unique_lock lock(guard_);
  while (!ends_.wait_for(lock, 1ms, [this] { return ending_; })) {
    (void)advance();
    lock.unlock();
    read_control();
    lock.lock();
  }
}

/// Only on the thread.
void StandInDevice::read_control() {
  if (control_ < 0) return;
  std::array<char, 64> bytes{};
  const ssize_t count = ::read(control_, bytes.data(), bytes.size());
  if (count <= 0) return;
  heard_.append(bytes.data(), static_cast<std::size_t>(count));
  for (std::size_t end = heard_.find('\n'); end != std::string::npos; end = heard_.find('\n')) {
    const std::string line = heard_.substr(0, end);
    heard_.erase(0, end + 1);
    if (!obey(line))
      std::fprintf(stderr, "stand-in: '%s' is not unplug, plug, press N, hold S or mark\n", line.c_str());
  }
}

}  // namespace forcebound::test
