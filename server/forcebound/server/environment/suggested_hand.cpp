#include "forcebound/server/environment/suggested_hand.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/control/rotation.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr time::Nanoseconds kTick = std::chrono::milliseconds{1};

// How far from what has no end a surface is looked for, and how far beside what has one [m].
constexpr double kUnboundedHalf_m = 0.1;
constexpr double kBeside_m = 0.01;
constexpr int kLineSteps = 4000;

std::string device_for(const scene::SceneFacts& facts) {
  // It tells where the points of a tool are, and shows what turns it.
  if (facts.tool) return "arm-6dof";
  if (facts.degrees_of_freedom == 3) return "omni";
  return facts.degrees_of_freedom == 2 ? "cartesian-2dof" : "wall-1dof";
}

device::SimulatedDevice make_device(const SuggestedHand& suggested) {
  device::DeviceDescription description = device::load_device(suggested.device);
  auto hand = device::make_operator(suggested.hand, description.facts);
  return {std::move(description), std::move(hand)};
}

/// As a client tells it: the tip of the tool in the hand.
control::Vector tip_of(const scene::Scene& scene, const device::Reading& reading) {
  const control::Vector& tool_m = scene.facts().tool_m;
  if (tool_m.rows() == 0 || !reading.handle.orientation) return reading.position;
  return reading.position + control::quaternion_of(*reading.handle.orientation) * control::translation_of(tool_m);
}

bool has_surface(const scene::Scene& scene) { return !scene.objects().empty() || !scene.dynamic_models().empty(); }

/// Rounded to 1 um: simulated shapes are at least 1 mm in size.
std::string metres(double length_m) {
  const double rounded_m = std::round(length_m * 1e6) / 1e6;
  return text::to_text(rounded_m == 0 ? 0 : rounded_m);  // no "-0"
}

/// "offset_x_m=0.03,offset_z_m=0.01": without those that are zero.
std::string offset_text(const scene::Point& offset_m) {
  std::string text;
  for (const Eigen::Index axis : {0, 1, 2}) {
    const std::string value = metres(offset_m[axis]);
    if (value == "0") continue;
    text += (text.empty() ? "offset_" : ",offset_") + std::string(1, "xyz"[axis]) + "_m=" + value;
  }
  return text;
}

std::string specification(const std::string& name, const std::vector<std::string>& settings) {
  std::string text = name;
  for (const std::string& setting : settings) {
    if (!setting.empty()) text += (text == name ? ":" : ",") + setting;
  }
  return text;
}

/// The places where a straight path along an axis leaves free space, in the order met. The shapes' states change on the
/// way as they would for a device.
std::vector<double> entries_m(const scene::Shape& shape, const scene::Point& from_m, Eigen::Index axis, double way_m) {
  // Aligned for any shape's state, which is zero at first.
  std::vector<double> state(shape.facts().state_bytes / sizeof(double) + 1, 0.0);
  std::vector<double> found_m;
  bool was_free = false;
  for (int i = 0; i <= kLineSteps; ++i) {
    scene::Point at_m = from_m;
    at_m[axis] += way_m * i / kLineSteps;
    // NOLINTNEXTLINE: bytes of its own
    const scene::SurfacePoint found = shape.nearest(at_m, reinterpret_cast<std::byte*>(state.data()));
    const bool is_free = !(found.penetration_m > 0);
    // The surface lies behind this point by the penetration.
    if (was_free && !is_free) found_m.push_back(at_m[axis] + found.penetration_m * found.normal[axis]);
    was_free = is_free;
  }
  return found_m;
}

/// As large as need be to have a shape's surface in it.
Eigen::AlignedBox3d search_box_m(const scene::ShapeFacts& facts) {
  const bool bounded = !facts.bounds_m.isEmpty() && facts.bounds_m.sizes().allFinite();
  const Eigen::AlignedBox3d about = scene::bounds_about(facts.on_surface_m, scene::Point::Constant(kUnboundedHalf_m));
  if (!bounded) return about;
  return {scene::Point(facts.bounds_m.min().array() - kBeside_m),
          scene::Point(facts.bounds_m.max().array() + kBeside_m)};
}

/// Of a shape, or within the bounds of a dynamic model.
bool is_inside(const scene::Scene& scene, const scene::Point& place_m) {
  const auto in_object = [&](const scene::SceneObject& object) {
    std::vector<double> state(object.shape->facts().state_bytes / sizeof(double) + 1, 0.0);
    // NOLINTNEXTLINE: bytes of its own
    return object.shape->nearest(place_m, reinterpret_cast<std::byte*>(state.data())).penetration_m > 0;
  };
  const auto in_model = [&](const scene::SceneDynamicModel& model) {
    return model.dynamic_model->facts().bounds_m.contains(place_m);
  };
  return std::ranges::any_of(scene.objects(), in_object) || std::ranges::any_of(scene.dynamic_models(), in_model);
}

std::string stroke_at(const scene::Point& top_m, const Eigen::AlignedBox3d& bounds_m) {
  constexpr double kDepth_m = 0.008;
  constexpr double kLength_m = 0.03;
  std::vector<std::string> settings{offset_text(top_m)};
  if (!bounds_m.isEmpty() && bounds_m.sizes().allFinite()) {
    const scene::Point size_m = bounds_m.sizes();
    if (const double depth_m = 0.2 * size_m.z(); depth_m < kDepth_m) settings.push_back("depth_m=" + metres(depth_m));
    if (const double length_m = 0.5 * size_m.head<2>().minCoeff(); length_m < kLength_m) {
      settings.push_back("length_m=" + metres(length_m));
    }
  }
  return specification("stroke", settings);
}

void add_strokes(const scene::Scene& scene, std::vector<std::string>& hands) {
  for (const scene::SceneObject& object : scene.objects()) {
    const scene::ShapeFacts facts = object.shape->facts();
    const Eigen::AlignedBox3d box_m = search_box_m(facts);
    for (const scene::Point& middle_m : {scene::Point(box_m.center()), facts.on_surface_m}) {
      const scene::Point above_m(middle_m.x(), middle_m.y(), box_m.max().z());
      const std::vector<double> tops_m = entries_m(*object.shape, above_m, 2, -box_m.sizes().z());
      if (tops_m.empty()) continue;
      hands.push_back(stroke_at({middle_m.x(), middle_m.y(), tops_m.front()}, facts.bounds_m));
    }
  }
  for (const scene::SceneDynamicModel& dynamic_model : scene.dynamic_models()) {
    const scene::DynamicModelFacts facts = dynamic_model.dynamic_model->facts();
    hands.push_back(stroke_at(facts.on_surface_m, facts.bounds_m));
  }
}

/// @param softly for devices of 3.3 N
std::string press_on(Eigen::Index axis, double entry_m, double direction, bool softly) {
  constexpr double kClearance_m = 0.01;
  const double depth_m = softly ? 0.01 : 0.02;
  return specification(
      "press", {axis == 0 ? "" : "axis=" + std::to_string(axis), "from_m=" + metres(entry_m - direction * kClearance_m),
                "to_m=" + metres(entry_m + direction * depth_m), softly ? "stiffness_N_per_m=300" : ""});
}

void add_presses(const scene::Scene& scene, Eigen::Index axes, std::vector<std::string>& hands) {
  for (const scene::SceneObject& object : scene.objects()) {
    const Eigen::AlignedBox3d box_m = search_box_m(object.shape->facts());
    for (Eigen::Index axis = 0; axis < axes; ++axis) {
      for (const double direction : {1.0, -1.0}) {
        // A press goes through the origin.
        scene::Point from_m = scene::Point::Zero();
        from_m[axis] = direction > 0 ? box_m.min()[axis] : box_m.max()[axis];
        for (const double entry_m : entries_m(*object.shape, from_m, axis, direction * box_m.sizes()[axis])) {
          hands.push_back(press_on(axis, entry_m, direction, axes > 1));
        }
      }
    }
  }
}

std::string wave_about(const scene::Point& middle_m, Eigen::Index axes) {
  scene::Point offset_m = scene::Point::Zero();
  offset_m.head(axes) = middle_m.head(axes);
  return specification("wave", {offset_text(offset_m)});
}

std::vector<std::string> candidates(const scene::Scene& scene) {
  const Eigen::Index axes = std::max(1, scene.facts().degrees_of_freedom);
  std::vector<std::string> hands;
  if (axes == 1) hands.emplace_back("press");
  if (axes == 3) add_strokes(scene, hands);
  add_presses(scene, axes, hands);
  for (std::size_t part = 0; part < scene.parts(); ++part) hands.push_back(wave_about(scene.on_surface_m(part), axes));
  return hands;
}

/// None for a hand that the device cannot hold, such as one whose computed place is not a finite number.
std::optional<HandTrial> trial_if_possible(const std::shared_ptr<const scene::Scene>& scene,
                                           const SuggestedHand& suggested) {
  try {
    return try_hand(scene, suggested);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

[[noreturn]] void refuse_device(const config::CheckedTable& scene, const config::Node& where,
                                const std::string& device) {
  const std::vector<std::string> known = device::shipped_device_names();
  scene.fail(where, "suggested_device: no device '" + device + "' ships" + text::suggestion(device, known));
}

}  // namespace

void parse_suggestion(config::CheckedTable& scene, scene::SceneFacts& facts) {
  SuggestedHand suggested{.device = device_for(facts), .hand = {}};
  if (const config::Node* const where = scene.find("suggested_device")) {
    suggested.device = scene.text("suggested_device");
    const std::vector<std::string> known = device::shipped_device_names();
    if (std::ranges::find(known, suggested.device) == known.end()) refuse_device(scene, *where, suggested.device);
    const int device_dof = device::load_device(suggested.device).facts.translations();
    if (!facts.accepts(static_cast<std::uint32_t>(device_dof))) {
      scene.fail(*where, "suggested_device: this scene accepts " + facts.accepted_degrees_of_freedom() +
                             " degrees of freedom, '" + suggested.device + "' has " + std::to_string(device_dof));
    }
    facts.suggested_device = suggested.device;
  }
  if (const config::Node* const where = scene.find("suggested_hand")) {
    suggested.hand = scene.text("suggested_hand");
    if (suggested.hand.starts_with("replay")) {
      scene.fail(*where, "suggested_hand: a recorded hand lies with the client, not with the scene; suggest another");
    }
    try {
      (void)make_device(suggested);
    } catch (const std::exception& error) {
      scene.fail(*where, "suggested_hand: " + std::string(error.what()));
    }
    facts.suggested_hand = suggested.hand;
  }
}

SuggestedHand suggested_hand(const std::shared_ptr<const scene::Scene>& scene) {
  const scene::SceneFacts& facts = scene->facts();
  SuggestedHand suggested{.device = facts.suggested_device.empty() ? device_for(facts) : facts.suggested_device,
                          .hand = facts.suggested_hand};
  if (!suggested.hand.empty()) return suggested;
  suggested.computed = true;
  suggested.hand = "wave";
  if (!has_surface(*scene)) return suggested;
  std::optional<SuggestedHand> first;
  for (const std::string& hand : candidates(*scene)) {
    SuggestedHand candidate = suggested;
    candidate.hand = hand;
    const std::optional<HandTrial> trial = trial_if_possible(scene, candidate);
    if (!trial) continue;
    if (trial->touched_s && !trial->starts_inside) return candidate;
    if (!first) first = std::move(candidate);
  }
  return first.value_or(suggested);
}

control::Vector place_to_begin(const scene::Scene& scene) {
  constexpr Eigen::Index kSpace = 3;
  const scene::SceneFacts& facts = scene.facts();
  const int axes = facts.degrees_of_freedom == scene::kAnyDegreesOfFreedom ? kSpace : facts.degrees_of_freedom;
  if (!facts.suggested_hand.empty()) {
    const std::string device =
        facts.suggested_device.empty() && facts.tool ? device_for(facts) : facts.suggested_device;
    const auto hand = device.empty() ? device::make_operator(facts.suggested_hand, axes)
                                     : device::make_operator(facts.suggested_hand, device::load_device(device).facts);
    return hand->target(0).position;
  }
  constexpr double kStep_m = 0.005;
  constexpr double kFarthest_m = 0.25;  // of what a hand reaches
  const scene::Point first_m(-0.02, 0, axes == kSpace ? 0.03 : 0.0);
  const scene::Point way = axes == kSpace ? scene::Point::UnitZ() : scene::Point(-scene::Point::UnitX());
  scene::Point place_m = first_m;
  while (is_inside(scene, place_m) && (place_m - first_m).norm() < kFarthest_m) place_m += kStep_m * way;
  return control::Vector(place_m.head(axes));
}

std::string to_options(const SuggestedHand& suggested) {
  return "--device " + suggested.device + " --operator " + suggested.hand;
}

HandTrial try_hand(const std::shared_ptr<const scene::Scene>& scene, const SuggestedHand& suggested) {
  device::SimulatedDevice device = make_device(suggested);
  const control::DeviceFacts& facts = device.facts();
  scene::SceneState state(scene, static_cast<std::uint32_t>(facts.translations()));
  const bool surface = has_surface(*scene);
  for (time::Nanoseconds now{0}; time::to_seconds(now) <= HandTrial::kLongest_s; now += kTick) {
    const device::Reading reading = device.read(now);
    if (!reading.position.allFinite()) break;
    const scene::Answer answer = state.answer(tip_of(*scene, reading), now, {}, false, reading.handle);
    // A device within an object that does not push, such as a viscous one, has not touched it.
    const bool touches = !answer.force.isZero(0) && (!surface || answer.penetration_m > 0);
    if (touches) {
      return {.starts_inside = surface && now == time::Nanoseconds{0},
              .touched_s = time::to_seconds(now),
              .contacts = state.contacts()};
    }
    // Until then only fields push, which a device resists up to its limit.
    const double force_N = answer.force.norm();
    device.apply(
        now, force_N > facts.force_N_max ? control::Vector(facts.force_N_max / force_N * answer.force) : answer.force);
  }
  return {};
}

}  // namespace forcebound::server
