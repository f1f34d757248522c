#include "forcebound/device/simulated/operator_settings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/device/simulated/smooth_step.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::device {
namespace {

std::string written(double value) { return control::joined(value); }

}  // namespace

OperatorSettings::OperatorSettings(std::string name, std::string_view text) : name_(std::move(name)) {
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) refuse("expected key=value, got '" + std::string(item) + "'");
    const std::string key(item.substr(0, equals));
    const std::string_view value = item.substr(equals + 1);
    const auto number = text::finite_number(value);
    if (!number) refuse(key + " must be a finite number, got '" + std::string(value) + "'");
    const bool twice = std::any_of(given_.begin(), given_.end(), [&](const auto& other) { return other.first == key; });
    if (twice) refuse(key + " is given twice");
    given_.emplace_back(key, *number);
  }
}

void OperatorSettings::refuse(const std::string& message) const {
  throw std::invalid_argument("operator '" + name_ + "': " + message);
}

double OperatorSettings::use(const std::string& key, double otherwise) {
  const auto found = std::find_if(given_.begin(), given_.end(), [&](const auto& item) { return item.first == key; });
  const double value = found == given_.end() ? otherwise : found->second;
  used_.emplace_back(key, value);
  return value;
}

double OperatorSettings::number(const std::string& key, Allowed allowed, double otherwise) {
  const double value = use(key, otherwise);
  if (allowed == Allowed::positive && !(value > 0)) refuse(key + " must be > 0, got " + written(value));
  if (allowed == Allowed::not_negative && !(value >= 0)) refuse(key + " must be >= 0, got " + written(value));
  return value;
}

int OperatorSettings::integer(const std::string& key, int least, int most, int otherwise) {
  const double value = use(key, otherwise);
  if (value != std::round(value) || value < least || value > most) {
    refuse(key + " must be a whole number from " + std::to_string(least) + " to " + std::to_string(most) + ", got " +
           written(value));
  }
  return static_cast<int>(value);
}

Hand OperatorSettings::hand(const Hand& otherwise) {
  Hand hand{.mass_kg = number("mass_kg", Allowed::not_negative, otherwise.mass_kg),
            .stiffness_N_per_m = number("stiffness_N_per_m", Allowed::not_negative, otherwise.stiffness_N_per_m),
            .damping_N_s_per_m = number("damping_N_s_per_m", Allowed::not_negative, otherwise.damping_N_s_per_m)};
  if (!tip_turns_) return hand;
  const Hand& wrist = kRelaxedWrist;
  hand.inertia_kg_m2 = number("inertia_kg_m2", Allowed::not_negative, wrist.inertia_kg_m2);
  hand.rotation_stiffness_N_m_per_rad =
      number("rotation_stiffness_N_m_per_rad", Allowed::not_negative, wrist.rotation_stiffness_N_m_per_rad);
  hand.rotation_damping_N_m_s_per_rad =
      number("rotation_damping_N_m_s_per_rad", Allowed::not_negative, wrist.rotation_damping_N_m_s_per_rad);
  return hand;
}

OperatorSettings::Turning OperatorSettings::turning() {
  if (!tip_turns_) return {};
  Turning turning;
  turning.amplitude_rad.x() = number("turn_x_rad", Allowed::any, 0);
  turning.amplitude_rad.y() = number("turn_y_rad", Allowed::any, 0);
  turning.amplitude_rad.z() = number("turn_z_rad", Allowed::any, 0);
  turning.frequency_Hz = number("turn_Hz", Allowed::not_negative, 0.5);
  return turning;
}

std::optional<Press> OperatorSettings::press() {
  also_known_ = {"button", "button_from_s", "button_until_s"};
  const bool any = std::ranges::any_of(
      given_, [&](const auto& item) { return std::ranges::find(also_known_, item.first) != also_known_.end(); });
  if (!any) return std::nullopt;
  Press press{.button = integer("button", 0, control::Handle::kButtons - 1, 0),
              .from_s = number("button_from_s", Allowed::not_negative, 0)};
  const bool ends =
      std::ranges::find(given_, "button_until_s", [](const auto& item) { return item.first; }) != given_.end();
  if (ends) press.until_s = number("button_until_s", Allowed::not_negative, 0);
  return press;
}

Vector OperatorSettings::offset(int dof) {
  constexpr std::string_view kAxes = "xyzuvw";
  Vector offset(dof);
  for (int i = 0; i < dof; ++i) {
    const std::string key = std::string("offset_") + kAxes[static_cast<std::size_t>(i)] + "_m";
    offset[i] = number(key, Allowed::any, 0);
  }
  return offset;
}

void OperatorSettings::refuse_other_keys() const {
  std::vector<std::string> known;
  for (const auto& item : used_) known.push_back(item.first);
  for (const std::string& key : also_known_) {
    if (std::ranges::find(known, key) == known.end()) known.push_back(key);
  }
  for (const auto& [key, value] : given_) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    refuse("unknown key '" + key + "'" + text::suggestion(key, known));
  }
}

std::string OperatorSettings::complete() const {
  std::string text = name_;
  // A file's name has its colon already.
  char separator = name_.find(':') == std::string::npos ? ':' : ',';
  for (const auto& [key, value] : used_) {
    text += separator + key + "=" + written(value);
    separator = ',';
  }
  return text;
}

control::Handle SpecifiedOperator::handle(double time_s) const noexcept {
  if (!press_) return {};
  const bool pressed = time_s >= press_->from_s && time_s < press_->until_s;
  return {.buttons = pressed ? 1U << static_cast<unsigned>(press_->button) : 0U};
}

Eigen::Vector3d SpecifiedOperator::turn(double time_s) const noexcept {
  // As far apart as axes of WaveOperator, so that the turning never repeats.
  const Eigen::Array3d paces(1, 1.4142136, 0.7320508);
  const double angle = 2 * std::numbers::pi * turning_.frequency_Hz * time_s;
  return smooth_step(time_s).value * turning_.amplitude_rad.array() * (angle * paces).sin();
}

}  // namespace forcebound::device
