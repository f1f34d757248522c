#include "forcebound/device/load_device.hpp"

#include <filesystem>
#include <stdexcept>

#include "forcebound/config/toml_section.hpp"
#include "forcebound/device/shipped_devices.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::device {
namespace {

constexpr double kHoldMax = 1.0;         // a force in effect for longer without a new one is not "held"
constexpr double kPeriodLeast_s = 1e-4;  // a faster loop would leave other threads no time
constexpr double kPeriodMost_s = 0.1;
constexpr double kLatencyMax = 0.01;  // ten ticks: a device slower than that is not for 1 kHz

void read_joints(config::TomlSection& file, DeviceDescription& device, int dof) {
  const bool arm = device.arm.has_value();
  control::DeviceFacts& facts = device.facts;
  device.inertia = file.matrix(arm ? "joint_inertia_kg_m2" : "mass_kg", dof);
  facts.damping = file.matrix(arm ? "joint_damping_N_m_s_per_rad" : "damping_N_s_per_m", dof);
  facts.friction = file.vector_or(arm ? "joint_friction_N_m" : "friction_N", dof, config::Allowed::not_negative, 0);
  facts.encoder_step =
      file.vector_or(arm ? "encoder_step_rad" : "encoder_step_m", dof, config::Allowed::not_negative, 0);
  facts.actuator_step =
      file.vector_or(arm ? "actuator_step_N_m" : "actuator_step_N", dof, config::Allowed::not_negative, 0);
}

void read_limits(config::TomlSection& file, control::DeviceFacts& facts) {
  facts.period_s = file.number_or("period_s", config::Allowed::positive, facts.period_s);
  if (facts.period_s < kPeriodLeast_s || facts.period_s > kPeriodMost_s) file.refuse("period_s", "0.0001 to 0.1");
  facts.force_N_max = file.number("force_N_max", config::Allowed::positive);
  facts.hold_s_max = file.number_or("hold_s_max", config::Allowed::positive, facts.hold_s_max);
  if (facts.hold_s_max > kHoldMax) file.refuse("hold_s_max", "<= 1");
  if (facts.hold_s_max < facts.period_s) file.refuse("hold_s_max", ">= period_s, or no force would last a tick");
  facts.releases = file.flag_or("releases", facts.releases);
  facts.latency_s = file.number_or("latency_s", config::Allowed::not_negative, facts.latency_s);
  if (facts.latency_s > kLatencyMax) file.refuse("latency_s", "<= 0.01");
}

ArmGeometry read_arm(config::TomlSection section) {
  ArmGeometry arm;
  arm.upper_length_m = section.number("upper_length_m", config::Allowed::positive);
  arm.fore_length_m = section.number("fore_length_m", config::Allowed::positive);
  arm.origin_reach_m = section.number("origin_reach_m", config::Allowed::any);
  arm.origin_height_m = section.number("origin_height_m", config::Allowed::any);
  section.refuse_other_keys();
  return arm;
}

}  // namespace

DeviceDescription parse_device(std::string_view toml_text, const std::string& place) {
  const toml::table table = config::parse_toml(toml_text, place);
  DeviceDescription device;
  device.facts.name = std::filesystem::path(place).stem().string();
  config::TomlSection file(table, place, "device '" + device.facts.name + "'");
  const std::string kind = file.text("kind");
  if (kind != "cartesian" && kind != "arm") file.refuse("kind", "\"cartesian\" or \"arm\"");
  device.facts.cartesian = kind == "cartesian";
  const int dof_least = device.facts.cartesian ? 1 : 3;
  const int dof_most = device.facts.cartesian ? control::kDofMax : 3;
  const int dof = file.integer("degrees_of_freedom", dof_least, dof_most);
  if (kind == "arm") device.arm = read_arm(file.section("arm"));
  read_joints(file, device, dof);
  read_limits(file, device.facts);
  file.refuse_other_keys();
  return device;
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
