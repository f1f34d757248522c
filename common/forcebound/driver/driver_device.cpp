#include "forcebound/driver/driver_device.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "forcebound/device/tick_rate.hpp"
#include "forcebound/driver/driver_facts.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::driver {
namespace {

// `now` was read before the encoders were: by so much at most.
constexpr Nanoseconds kAhead = std::chrono::milliseconds{1};

forcebound_facts told_by(const forcebound_driver& driver, forcebound_device* device) {
  forcebound_facts told{};
  told.size = sizeof told;
  if (driver.describe(device, &told) != FORCEBOUND_OK) {
    throw std::runtime_error("driver '" + std::string(driver.name) + "' does not describe its device");
  }
  return told;
}

control::Handle handle_of(const forcebound_reading& told) noexcept {
  control::Handle handle;
  if ((told.has & FORCEBOUND_HAS_BUTTONS) != 0) handle.buttons = told.buttons;
  if ((told.has & FORCEBOUND_HAS_GRIPPER) != 0) handle.gripper = told.gripper;
  if ((told.has & FORCEBOUND_HAS_ORIENTATION) != 0)
    std::ranges::copy(told.orientation, handle.orientation.emplace().begin());
  return handle;
}

std::string axes_in_words(const control::DeviceFacts& facts) {
  const std::string of_tip = std::to_string(facts.degrees_of_freedom()) + " axes of the tip";
  if (facts.cartesian) return of_tip;
  return std::to_string(facts.joints()) + " joints" + (facts.tip_axes > 0 ? " for " + of_tip : "");
}

void expect_same_axes(const control::DeviceFacts& file, const control::DeviceFacts& told,
                      const DriverRequest& request) {
  if (file.joints() == told.joints() && file.tip_axes == told.tip_axes && file.cartesian == told.cartesian) return;
  throw std::runtime_error(request.facts_file + ": has " + axes_in_words(file) + ", but the device of driver '" +
                           request.name + "' has " + axes_in_words(told));
}

/// Limits of a user's file. One that does not say what the motors may give for ever leaves it to the driver, which may
/// know it.
device::Safety own_safety(const device::RealDevice& own, const forcebound_facts& told) {
  device::Safety safety = own.safety;
  const bool unsaid = safety.rms_force_N_max == device::Safety::of_a_person(own.facts).rms_force_N_max;
  if (unsaid && told.force_N_continuous > 0) safety.rms_force_N_max = told.force_N_continuous;
  return safety;
}

}  // namespace

DriverRequest DriverRequest::parse(std::string_view text) {
  const std::size_t colon = text.find(':');
  DriverRequest request{.name = std::string(text.substr(0, colon))};
  std::string_view rest = colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
    const std::size_t equals = item.find('=');
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument("device '" + text::printable(request.name) + "': " + why);
    };
    if (equals == std::string_view::npos || equals == 0) {
      refuse("expected KEY=VALUE, got '" + text::printable(item) + "'");
    }
    std::string key(item.substr(0, equals));
    std::string value(item.substr(equals + 1));
    const bool twice = std::ranges::any_of(request.settings, [&](const auto& other) { return other.first == key; });
    if (twice || (key == "facts" && !request.facts_file.empty())) refuse(key + " is given twice");
    if (key != "facts") {
      request.settings.emplace_back(std::move(key), std::move(value));
    } else if (value.empty()) {
      refuse("facts must be the path of a .toml file");
    } else {
      request.facts_file = std::move(value);
    }
  }
  return request;
}

DriverDevice::DriverDevice(std::shared_ptr<const DriverLibrary> library, const DriverRequest& request,
                           std::optional<device::RealDevice> own)
    : library_(std::move(library)) {
  std::vector<forcebound_setting> settings;
  settings.reserve(request.settings.size());
  for (const auto& [key, value] : request.settings) settings.push_back({key.c_str(), value.c_str()});
  std::array<char, FORCEBOUND_TEXT_BYTES> error{};
  const int opened = driver().open(settings.data(), settings.size(), &device_, error.data(), error.size());
  if (opened != FORCEBOUND_OK) {
    const std::string_view why(error.data(), ::strnlen(error.data(), error.size()));
    throw std::runtime_error("driver '" + request.name + "': " + (why.empty() ? "no device" : text::printable(why)));
  }
  try {
    const forcebound_facts told = told_by(driver(), device_);
    identified_ = told.identified != 0;
    facts_ = facts_of(told, driver().name);
    safety_ = safety_of(told, facts_, driver().name);
    if (own) {
      expect_same_axes(own->facts, facts_, request);
      safety_ = own_safety(*own, told);
      facts_ = std::move(own->facts);
      identified_ = own->identified;
      guessed_by_ = "its file";
    }
    damping_ = control::Damping::from_matrix(facts_.damping);
  } catch (...) {
    driver().close(device_);
    throw;
  }
}

DriverDevice::~DriverDevice() {
  try {
    driver().stop(device_);
    driver().close(device_);
  } catch (...) {  // of a driver in C++; there is nobody left to tell
  }
}

void DriverDevice::run_at(double rate_Hz) {
  const double own_Hz = 1 / facts_.period_s;
  constexpr double kRounding = 1e-9;
  // Ticks between two readings would have none, and no force.
  if (rate_Hz > own_Hz * (1 + kRounding)) {
    throw std::invalid_argument("driver '" + std::string(driver().name) + "' reads its device " +
                                text::rounded(own_Hz) + " times a second: at most so many ticks are accepted, got " +
                                text::rounded(rate_Hz));
  }
  facts_ = device::at_tick_rate(facts_, rate_Hz);
}

std::string DriverDevice::facts_in_words() const {
  return HapticDevice::facts_in_words() + (identified_ ? "" : "; bounds not identified: guesses of " + guessed_by_);
}

void DriverDevice::start() {
  if (driver().start(device_) == FORCEBOUND_OK) return;
  if (!note_drivers_error("does not start")) ++counters_.unexplained;
  throw std::runtime_error("driver '" + std::string(driver().name) + "': " + std::string(last_error()));
}

device::Reading DriverDevice::read(Nanoseconds now) noexcept {
  forcebound_reading told{};
  told.size = sizeof told;
  int result = FORCEBOUND_FAILED;
  try {
    result = driver().read(device_, now.count(), &told);
  } catch (...) {
    note_error("the driver threw an exception");
    return failed();
  }
  if (result == FORCEBOUND_OK || result == FORCEBOUND_STALE) note_reports(told);
  if (result == FORCEBOUND_OK) return reading_of(told, now);
  if (result == FORCEBOUND_STALE) {
    device::Reading stale = failed();
    stale.status = device::Reading::Status::stale;
    return stale;
  }
  const bool unplugged = result == FORCEBOUND_UNPLUGGED;
  const bool explained = note_drivers_error(unplugged ? "the device is unplugged" : "no reading");
  if (!explained && !unplugged) ++counters_.unexplained;
  return failed();
}

device::Reading DriverDevice::reading_of(const forcebound_reading& told, Nanoseconds now) noexcept {
  const int dof = facts_.degrees_of_freedom();
  const Nanoseconds latched{told.latched_ns};
  if (latched_ && latched < *latched_) {
    ++counters_.times_refused;
    note_error("its readings run backwards in time");
    return failed();
  }
  if (latched > now + kAhead) {
    ++counters_.times_refused;
    note_error("its reading was latched in the future");
    return failed();
  }
  if (latched_ && latched == *latched_) {
    device::Reading stale = failed();
    stale.status = device::Reading::Status::stale;
    return stale;
  }
  device::Reading reading;
  reading.latched = latched;
  reading.position = Eigen::Map<const Eigen::VectorXd>(told.position_m, facts_.translations());
  if (facts_.cartesian) {
    reading.joint = reading.position;
    reading.jacobian = Matrix::Identity(dof, dof);
  } else {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    reading.joint = Eigen::Map<const Eigen::VectorXd>(told.joint, dof);
    reading.jacobian = Eigen::Map<const RowMajor>(told.jacobian, dof, dof);
    if (reading.jacobian.allFinite()) damping_ = control::Damping::from_joints(reading.jacobian, facts_.damping);
  }
  reading.damping = &damping_;
  const control::SoundHandle handle = control::sound(handle_of(told));
  reading.handle = handle.handle;
  if (handle.refused > 0) {
    counters_.handle_refused += static_cast<std::uint64_t>(handle.refused);
    note_error("its orientation is no unit quaternion, or its gripper is not within 0 to 1");
  }
  if (!device::is_usable(reading, facts_)) {
    note_error(facts_.rotations > 0 && !reading.handle.orientation
                   ? "its reading has no orientation, which a device that shows torques must tell"
                   : "its reading has numbers that are not finite");
    return failed();
  }
  latched_ = latched;
  return reading;
}

/// Reports of the last command, as far as they can be true.
void DriverDevice::note_reports(const forcebound_reading& told) noexcept {
  if ((told.has & FORCEBOUND_HAS_EFFECTIVE) == 0) return;
  effective_at_ = told.effective_ns > 0 ? std::optional(Nanoseconds{told.effective_ns}) : std::nullopt;
  released_at_ = told.released_ns > 0 ? std::optional(Nanoseconds{told.released_ns}) : std::nullopt;
}

device::Reading DriverDevice::failed() const noexcept {
  const int dof = facts_.degrees_of_freedom();
  return {.joint = Vector::Zero(dof),
          .position = Vector::Zero(facts_.translations()),
          .jacobian = Matrix::Identity(dof, dof),
          .damping = &damping_,
          .latched = latched_.value_or(Nanoseconds{0}),
          .status = device::Reading::Status::failed};
}

void DriverDevice::apply(Nanoseconds now, const Vector& force_N) noexcept {
  const int dof = facts_.degrees_of_freedom();
  forcebound_command command{};
  command.size = sizeof command;
  command.at_ns = now.count();
  if (force_N.size() == dof && force_N.allFinite()) {
    Eigen::Map<Eigen::VectorXd>(command.force_N, facts_.translations()) = force_N.head(facts_.translations());
    Eigen::Map<Eigen::VectorXd>(command.torque_N_m, facts_.rotations) = force_N.tail(facts_.rotations);
  } else {
    ++counters_.faulty_commands;
  }
  effective_at_.reset();
  released_at_.reset();
  write_failed_ = true;
  int result = FORCEBOUND_FAILED;
  try {
    result = driver().command(device_, &command);
  } catch (...) {
    note_error("the driver threw an exception");
    ++counters_.failed_writes;
    return;
  }
  write_failed_ = result != FORCEBOUND_OK;
  if (!write_failed_) return;
  ++counters_.failed_writes;
  const bool explained = note_drivers_error("the command failed");
  if (!explained && result != FORCEBOUND_UNPLUGGED) ++counters_.unexplained;
}

void DriverDevice::stop(Nanoseconds /*now*/) noexcept {
  try {
    driver().stop(device_);
  } catch (...) {
    note_error("the driver threw an exception");
  }
}

void DriverDevice::note_error(std::string_view text) noexcept {
  error_bytes_ = std::min(text.size(), error_.size());
  std::copy_n(text.begin(), error_bytes_, error_.begin());
}

/// @returns whether the driver gave a reason
bool DriverDevice::note_drivers_error(std::string_view otherwise) noexcept {
  const char* text = nullptr;
  try {
    if (driver().last_error != nullptr) text = driver().last_error(device_);
  } catch (...) {
    text = nullptr;
  }
  const bool told = text != nullptr && *text != '\0';
  std::string_view words = told ? std::string_view(text, ::strnlen(text, error_.size())) : otherwise;
  while (words.ends_with('\n')) words.remove_suffix(1);
  note_error(words);
  text::make_printable({error_.data(), error_bytes_});
  return told;
}

}  // namespace forcebound::driver
