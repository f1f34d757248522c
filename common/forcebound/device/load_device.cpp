#include "forcebound/device/load_device.hpp"

#include <filesystem>
#include <stdexcept>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/device/shipped_devices.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::device {
namespace {

using config::NumberParameter;

/// Ten ticks: a device slower than that is not for 1 kHz.
constexpr double kLatencyMax_s = 0.01;

NumberParameter positive(std::string_view key) { return {.key = key, .least = 0, .least_excluded = true}; }
NumberParameter not_negative(std::string_view key) { return {.key = key, .preset = 0, .least = 0}; }

/// What a description is for: a simulation needs inertia and geometry too.
enum class Use : std::uint8_t { simulation, facts };

void read_joints(config::CheckedTable& file, DeviceDescription& device, int dof, Use use) {
  const bool arm = !device.facts.cartesian;
  control::DeviceFacts& facts = device.facts;
  const char* const inertia = arm ? "joint_inertia_kg_m2" : "mass_kg";
  if (use == Use::simulation || file.find(inertia) != nullptr) device.inertia = file.matrix(inertia, dof);
  facts.damping = file.matrix(arm ? "joint_damping_N_m_s_per_rad" : "damping_N_s_per_m", dof);
  facts.friction = file.vector(not_negative(arm ? "joint_friction_N_m" : "friction_N"), dof);
  facts.encoder_step = file.vector(not_negative(arm ? "encoder_step_rad" : "encoder_step_m"), dof);
  facts.actuator_step = file.vector(not_negative(arm ? "actuator_step_N_m" : "actuator_step_N"), dof);
}

void read_limits(config::CheckedTable& file, control::DeviceFacts& facts) {
  // A faster loop would leave other threads no time.
  facts.period_s = file.number({.key = "period_s", .preset = facts.period_s, .least = 1e-4, .most = 0.1});
  facts.force_N_max = file.number(positive("force_N_max"));
  // A force in effect for longer without a new one is not "held".
  facts.hold_s_max =
      file.number({.key = "hold_s_max", .preset = facts.hold_s_max, .least = 0, .least_excluded = true, .most = 1});
  if (facts.hold_s_max < facts.period_s) file.refuse("hold_s_max", ">= period_s, or no force would last a tick");
  // Of the force during its release, which ends within the second that the hold time may be too.
  facts.release_share = file.number({.key = "release_share", .preset = facts.release_share, .least = 0, .most = 1});
  facts.release_s = file.number({.key = "release_s", .preset = facts.release_s, .least = 0, .most = 1});
  if (facts.hold_s_max + facts.release_s > 1) file.refuse("release_s", "<= 1 s together with hold_s_max");
  facts.releases = file.flag("releases", facts.releases);
  facts.latency_s = file.number({.key = "latency_s", .preset = facts.latency_s, .least = 0, .most = kLatencyMax_s});
}

/// `KEY = [least, most]`, both 0 where absent.
control::Bracket read_bracket(config::CheckedTable& section, std::string_view key) {
  const config::Node* const node = section.find(key);
  if (node == nullptr) return {};
  const auto* const pair = node->as<config::Node::List>();
  if (pair == nullptr || pair->size() != 2) section.refuse(key, "two numbers, [least, most]");
  const Vector bounds = section.vector({.key = key, .least = -1, .most = 1}, 2);
  if (bounds[0] > bounds[1]) section.refuse(key, "two numbers, the smaller one first");
  return {bounds[0], bounds[1]};
}

double read_share(config::CheckedTable& section, std::string_view key) {
  const double share = section.number(not_negative(key));
  if (share >= 1) section.refuse(key, "a share >= 0 and < 1");
  return share;
}

control::Uncertainty read_uncertainty(config::CheckedTable section, const control::DeviceFacts& facts) {
  control::Uncertainty uncertainty;
  uncertainty.stamp_s = read_bracket(section, "stamp_s");
  uncertainty.latency_s = read_bracket(section, "latency_s");
  if (facts.latency_s + uncertainty.latency_s.least < 0) {
    section.refuse("latency_s", "no less than minus the latency, or a force would take effect before its command");
  }
  uncertainty.hold_s = read_bracket(section, "hold_s");
  if (facts.hold_s_max + uncertainty.hold_s.least <= 0) {
    section.refuse("hold_s", "more than minus the hold time, or no force would be held");
  }
  uncertainty.clock_share = read_share(section, "clock_share");
  uncertainty.encoder_steps = section.number({.key = "encoder_steps", .preset = 0, .least = 0, .most = 1000});
  uncertainty.damping_share = read_share(section, "damping_share");
  uncertainty.friction_share = read_share(section, "friction_share");
  uncertainty.torque_share = read_share(section, "torque_share");
  uncertainty.actuator_lag_s =
      section.number({.key = "actuator_lag_s", .preset = 0, .least = 0, .most = kLatencyMax_s});
  section.refuse_unknown_keys();
  return uncertainty;
}

ArmGeometry read_arm(config::CheckedTable section) {
  ArmGeometry arm;
  arm.upper_length_m = section.number(positive("upper_length_m"));
  arm.fore_length_m = section.number(positive("fore_length_m"));
  arm.origin_reach_m = section.number({.key = "origin_reach_m"});
  arm.origin_height_m = section.number({.key = "origin_height_m"});
  section.refuse_unknown_keys();
  return arm;
}

Safety read_safety(config::CheckedTable section, Safety safety) {
  const auto limit = [&](std::string_view key, double preset, double most) {
    return section.number({.key = key, .preset = preset, .least = 0, .most = most});
  };
  constexpr double kLongest_s = 60;
  constexpr double kMost = 1e3;
  safety.ramp_s = limit("ramp_s", safety.ramp_s, kLongest_s);
  safety.speed_m_per_s_max = limit("speed_m_per_s_max", safety.speed_m_per_s_max, kMost);
  safety.workspace_radius_m = limit("workspace_radius_m", safety.workspace_radius_m, kMost);
  safety.workspace_fade_m = section.number({.key = "workspace_fade_m",
                                            .preset = safety.workspace_fade_m,
                                            .least = 0,
                                            .least_excluded = true,
                                            .most = kMost});
  safety.rms_force_N_max = limit("rms_force_N_max", safety.rms_force_N_max, kMost);
  safety.rms_s =
      section.number({.key = "rms_s", .preset = safety.rms_s, .least = 0, .least_excluded = true, .most = 3600});
  constexpr NumberParameter kButton{
      .key = "dead_man_button", .least = 0, .most = control::Handle::kButtons - 1, .whole = true};
  if (section.find(kButton.key) != nullptr) safety.dead_man_button = section.whole(kButton);
  section.refuse_unknown_keys();
  return safety;
}

DeviceDescription parse_description(std::string_view toml_text, const std::string& place, Use use) {
  const config::Node node = config::parse_toml(toml_text, place);
  DeviceDescription device;
  device.facts.name = std::filesystem::path(place).stem().string();
  config::CheckedTable file(node, place, "device '" + device.facts.name + "'");
  const std::string kind = file.choice({.key = "kind", .choices = {"cartesian", "arm"}});
  device.facts.cartesian = kind == "cartesian";
  const bool any_dof = device.facts.cartesian || use == Use::facts;
  const int dof_least = any_dof ? 1 : 3;
  const int dof_most = any_dof ? control::kDofMax : 3;
  const int dof = file.whole(
      {.key = "degrees_of_freedom", .least = static_cast<double>(dof_least), .most = static_cast<double>(dof_most)});
  const bool has_arm = kind == "arm" && (use == Use::simulation || file.find("arm") != nullptr);
  if (has_arm) device.arm = read_arm(file.table("arm"));
  read_joints(file, device, dof, use);
  read_limits(file, device.facts);
  const char* const speed = !device.facts.cartesian ? "joint_speed_rad_per_s_max" : "speed_m_per_s_max";
  if (file.find(speed) != nullptr) device.facts.speed_max = file.vector(positive(speed), dof);
  if (file.find("uncertainty") != nullptr) {
    device.facts.uncertainty = read_uncertainty(file.table("uncertainty"), device.facts);
  }
  device.identified = file.flag("identified", device.identified);
  if (use == Use::facts) device.safety = Safety::of_a_person(device.facts);
  if (file.find("safety") != nullptr) device.safety = read_safety(file.table("safety"), device.safety);
  file.refuse_unknown_keys();
  return device;
}

}  // namespace

DeviceDescription parse_device(std::string_view toml_text, const std::string& place) {
  return parse_description(toml_text, place, Use::simulation);
}

RealDevice parse_facts(std::string_view toml_text, const std::string& place) {
  DeviceDescription description = parse_description(toml_text, place, Use::facts);
  return {.facts = std::move(description.facts), .safety = description.safety, .identified = description.identified};
}

bool names_a_file(std::string_view name_or_file) noexcept {
  return name_or_file.find('/') != std::string_view::npos || name_or_file.ends_with(".toml");
}

DeviceDescription load_device(const std::string& name_or_file) {
  if (names_a_file(name_or_file)) return parse_device(text::read_file(name_or_file), name_or_file);
  for (const text::EmbeddedText& device : shipped_devices()) {
    if (device.name == name_or_file) return parse_device(device.text, "devices/" + name_or_file + ".toml");
  }
  throw std::invalid_argument("unknown device '" + name_or_file + "'" +
                              text::suggestion(name_or_file, shipped_device_names()) + "; or the path of a .toml file");
}

std::vector<std::string> shipped_device_names() {
  std::vector<std::string> names;
  for (const text::EmbeddedText& device : shipped_devices()) names.emplace_back(device.name);
  return names;
}

}  // namespace forcebound::device
