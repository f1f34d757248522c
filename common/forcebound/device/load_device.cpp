#include "forcebound/device/load_device.hpp"

#include <filesystem>
#include <stdexcept>
#include <variant>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/device/kinematics/kinematics.hpp"
#include "forcebound/device/load_geometry.hpp"
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

void read_joints(config::CheckedTable& file, DeviceDescription& device, int count, Use use) {
  control::DeviceFacts& facts = device.facts;
  const bool arm = !facts.cartesian;
  const char* const inertia = arm ? "joint_inertia_kg_m2" : "mass_kg";
  if (use == Use::simulation || file.find(inertia) != nullptr) device.inertia = file.matrix(inertia, count);
  facts.damping = file.matrix(arm ? "joint_damping_N_m_s_per_rad" : "damping_N_s_per_m", count);
  facts.friction = file.vector(not_negative(arm ? "joint_friction_N_m" : "friction_N"), count);
  facts.encoder_step = file.vector(not_negative(arm ? "encoder_step_rad" : "encoder_step_m"), count);
  const char* const step = arm ? "actuator_step_N_m" : "actuator_step_N";
  facts.actuator_step = file.vector(not_negative(step), count);
  if (facts.tip_axes > 0 && !facts.actuator_step.isZero(0)) {
    file.refuse(step,
                "0 with more joints than degrees_of_freedom, as no force at the tip then gives every motor a whole "
                "number of steps; [uncertainty] torque_ripple_share is for them");
  }
}

void read_limits(config::CheckedTable& file, control::DeviceFacts& facts) {
  // A faster loop would leave other threads no time.
  facts.period_s = file.number({.key = "period_s", .preset = facts.period_s, .least = 1e-4, .most = 0.1});
  facts.force_N_max = file.number(positive("force_N_max"));
  constexpr std::string_view kTorque = "torque_N_m_max";
  if (facts.rotations > 0) {
    facts.torque_N_m_max = file.number(positive(kTorque));
  } else if (file.find(kTorque) != nullptr) {
    file.refuse(kTorque, "left out, as this tip shows no torque; kind = 'chain' with degrees_of_freedom = 6 does");
  }
  // A force in effect for longer without a new one is not "held".
  facts.hold_s_max =
      file.number({.key = "hold_s_max", .preset = facts.hold_s_max, .least = 0, .least_excluded = true, .most = 1});
  if (facts.hold_s_max < facts.period_s) file.refuse("hold_s_max", ">= period_s, or no force would last a tick");
  // Of the force during its release, which ends within the second that the hold time may be too.
  facts.release_share = file.number({.key = "release_share", .preset = facts.release_share, .least = 0, .most = 1});
  facts.release_s = file.number({.key = "release_s", .preset = facts.release_s, .least = 0, .most = 1});
  if (facts.hold_s_max + facts.release_s > 1) file.refuse("release_s", "<= 1 s together with hold_s_max");
  facts.releases = file.flag("releases", facts.releases);
  if (!facts.releases && facts.release_share > 0 && facts.release_s > 0) {
    file.refuse("release_share",
                "left out where releases = false, as such a device holds all of a force until the next");
  }
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

/// A share that a motor's gain may be more and less, or two, [least, most].
control::Bracket read_gain(config::CheckedTable& section, std::string_view key) {
  const config::Node* const node = section.find(key);
  const bool one = node != nullptr && node->as<config::Node::List>() == nullptr;
  const double share = one ? read_share(section, key) : 0;
  const control::Bracket gain = one ? control::Bracket{-share, share} : read_bracket(section, key);
  if (!(gain.least > -1)) section.refuse(key, "more than -1, or the motors' gain could be zero");
  return gain;
}

/// Its older name too.
double read_ripple(config::CheckedTable& section) {
  constexpr std::string_view kOlder = "torque_share";
  constexpr std::string_view kName = "torque_ripple_share";
  if (section.find(kOlder) == nullptr) return read_share(section, kName);
  if (section.find(kName) != nullptr) section.refuse(kOlder, "left out: it is the older name of torque_ripple_share");
  return read_share(section, kOlder);
}

control::Uncertainty read_uncertainty(config::CheckedTable section, const control::DeviceFacts& facts) {
  control::Uncertainty uncertainty;
  uncertainty.stamp_s = read_bracket(section, "stamp_s");
  uncertainty.latency_s = read_bracket(section, "latency_s");
  if (facts.latency_s + uncertainty.latency_s.least < 0) {
    section.refuse("latency_s", "no less than minus the latency, or a force would take effect before its command");
  }
  uncertainty.latency_offset_s = read_bracket(section, "latency_offset_s");
  if (facts.latency_s + uncertainty.latency_s.least + uncertainty.latency_offset_s.least < 0) {
    section.refuse("latency_offset_s",
                   "no less than minus the least latency, or a force would take effect before its command");
  }
  uncertainty.hold_s = read_bracket(section, "hold_s");
  if (facts.hold_s_max + uncertainty.hold_s.least <= 0) {
    section.refuse("hold_s", "more than minus the hold time, or no force would be held");
  }
  uncertainty.clock_share = read_share(section, "clock_share");
  uncertainty.encoder_steps = section.number({.key = "encoder_steps", .preset = 0, .least = 0, .most = 1000});
  uncertainty.damping_share = read_share(section, "damping_share");
  uncertainty.friction_share = read_share(section, "friction_share");
  uncertainty.torque_gain_share = read_gain(section, "torque_gain_share");
  uncertainty.losses_with_gain = section.flag("losses_with_gain", false);
  uncertainty.torque_ripple_share = read_ripple(section);
  uncertainty.actuator_lag_s =
      section.number({.key = "actuator_lag_s", .preset = 0, .least = 0, .most = kLatencyMax_s});
  section.refuse_unknown_keys();
  return uncertainty;
}

Safety read_safety(config::CheckedTable section, Safety safety, bool turns) {
  const auto limit = [&](std::string_view key, double preset, double most) {
    return section.number({.key = key, .preset = preset, .least = 0, .most = most});
  };
  constexpr double kLongest_s = 60;
  constexpr double kMost = 1e3;
  safety.ramp_s = limit("ramp_s", safety.ramp_s, kLongest_s);
  safety.speed_m_per_s_max = limit("speed_m_per_s_max", safety.speed_m_per_s_max, kMost);
  if (turns) safety.turn_rad_per_s_max = limit("turn_rad_per_s_max", safety.turn_rad_per_s_max, kMost);
  safety.workspace_radius_m = limit("workspace_radius_m", safety.workspace_radius_m, kMost);
  safety.workspace_fade_m = section.number({.key = "workspace_fade_m",
                                            .preset = safety.workspace_fade_m,
                                            .least = 0,
                                            .least_excluded = true,
                                            .most = kMost});
  safety.rms_force_N_max = limit("rms_force_N_max", safety.rms_force_N_max, kMost);
  if (turns) safety.rms_torque_N_m_max = limit("rms_torque_N_m_max", safety.rms_torque_N_m_max, kMost);
  safety.rms_s =
      section.number({.key = "rms_s", .preset = safety.rms_s, .least = 0, .least_excluded = true, .most = 3600});
  constexpr NumberParameter kButton{
      .key = "dead_man_button", .least = 0, .most = control::Handle::kButtons - 1, .whole = true};
  if (section.find(kButton.key) != nullptr) safety.dead_man_button = section.whole(kButton);
  section.refuse_unknown_keys();
  return safety;
}

/// How many axes the tip of a device of this kind can have.
struct AxesRange {
  double least = 1;
  double most = control::kDofMax;
};
AxesRange axes_of(std::string_view kind, Use use) {
  // Keys of a Cartesian device are in metres, which rotations are not.
  if (kind == "cartesian") return {1, 3};
  if (kind == "five_bar") return {2, 2};
  if (kind == "delta" || (kind == "arm" && use == Use::simulation)) return {3, 3};
  return {};
}

DeviceDescription parse_description(std::string_view toml_text, const std::string& place, Use use) {
  const config::Node node = config::parse_toml(toml_text, place);
  DeviceDescription device;
  device.facts.name = std::filesystem::path(place).stem().string();
  config::CheckedTable file(node, place, "device '" + device.facts.name + "'");
  const std::string kind = file.choice({.key = "kind", .choices = {"cartesian", "arm", "five_bar", "delta", "chain"}});
  device.facts.cartesian = kind == "cartesian";
  const AxesRange range = axes_of(kind, use);
  const int dof = file.whole({.key = "degrees_of_freedom", .least = range.least, .most = range.most});
  if (dof > kTranslations && dof < control::kDofMax && kind == "chain") {
    file.refuse("degrees_of_freedom", "1, 2 or 3, or 6 for a tip that turns as well");
  }
  if (kind == "chain" && dof == control::kDofMax) device.facts.rotations = dof - kTranslations;
  int joints = dof;
  // A chain's says how many joints there are.
  if (!device.facts.cartesian && use == Use::simulation) {
    (void)file.at(kind,
                  "a table, which a simulated device needs; a file of facts alone is a driver's: "
                  "driver:FILE.so:facts=" +
                      place);
  }
  const bool needs_geometry = !device.facts.cartesian && (use == Use::simulation || kind == "chain");
  if (!device.facts.cartesian && (needs_geometry || file.find(kind) != nullptr)) {
    device.geometry = read_geometry(file, kind, dof);
    if (const auto* chain = std::get_if<ChainGeometry>(&device.geometry))
      joints = static_cast<int>(chain->joints.size());
  }
  if (joints != dof) device.facts.tip_axes = dof;
  read_joints(file, device, joints, use);
  read_limits(file, device.facts);
  const char* const speed = !device.facts.cartesian ? "joint_speed_rad_per_s_max" : "speed_m_per_s_max";
  if (file.find(speed) != nullptr) device.facts.speed_max = file.vector(positive(speed), joints);
  if (file.find("uncertainty") != nullptr) {
    device.facts.uncertainty = read_uncertainty(file.table("uncertainty"), device.facts);
  }
  device.identified = file.flag("identified", device.identified);
  if (use == Use::facts) device.safety = Safety::of_a_person(device.facts);
  if (file.find("safety") != nullptr)
    device.safety = read_safety(file.table("safety"), device.safety, device.facts.rotations > 0);
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
  if (const std::size_t at = name_or_file.find(":facts="); at != std::string::npos) {
    throw std::invalid_argument("'" + name_or_file.substr(0, at) +
                                "' takes no facts: only a driver does, as in driver:" + "FILE.so" +
                                name_or_file.substr(at));
  }
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
