#include "forcebound/server/environment/explain.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "forcebound/config/parameter.hpp"
#include "forcebound/handover/scene_assembly.hpp"
#include "forcebound/scene/cost.hpp"
#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::server {
namespace {

using text::rounded;

constexpr double kTick_ns = 1e6;
const std::string kIndent = "              ";

std::string time_text(double ns) {
  if (ns < 1e3) return rounded(ns) + " ns";
  return ns < 1e6 ? rounded(ns * 1e-3) + " us" : rounded(ns * 1e-6) + " ms";
}

std::string bytes_text(std::size_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size < 10e3) return std::to_string(bytes) + " bytes";
  return size < 1e6 ? rounded(size * 1e-3) + " kB" : rounded(size * 1e-6) + " MB";
}

/// Measured cost of a part, less that of the motion included in the measurement; none if it was not measured.
std::optional<MeasuredCost> part_alone(const std::optional<Calibration>& calibration, std::size_t part) {
  if (!calibration) return std::nullopt;
  MeasuredCost cost = calibration->parts.at(part);
  cost.median_ns = std::max(0.0, cost.median_ns - calibration->motion.median_ns);
  cost.p99_ns = std::max(cost.median_ns, cost.p99_ns - calibration->motion.median_ns);
  return cost;
}

std::string cost_text(double predicted_ns, const std::optional<MeasuredCost>& measured) {
  std::string text = time_text(predicted_ns) + " predicted";
  if (measured) {
    text += ", " + time_text(measured->median_ns) + " measured (p99 " + time_text(measured->p99_ns) + ")" +
            (measured->left_out ? ", but left out during it: its force was not finite" : "");
  }
  return text;
}

/// Cost and memory of a part, summed over its effects.
struct PartSum {
  scene::Inputs inputs{};
  std::size_t state_bytes = 0;
  std::size_t memory_bytes = 0;
  double reach_m = 0;
};

/// @param points that feel it, each with states of its own
PartSum sum_of(const scene::SceneObject& part, std::size_t points) {
  PartSum sum;
  if (part.shape) {
    const scene::ShapeFacts shape = part.shape->facts();
    sum = {.state_bytes = shape.state_bytes, .memory_bytes = shape.memory_bytes};
  }
  for (const scene::RequestedEffect& requested : part.effects) {
    const scene::EffectFacts effect = requested.effect->facts();
    sum.inputs = sum.inputs.with(effect.inputs);
    sum.state_bytes += effect.state_bytes;
    sum.reach_m = std::max(sum.reach_m, effect.reach_m);
  }
  sum.state_bytes *= points;
  return sum;
}

/// @param implied further entries, besides the inputs
std::string implied_text(const scene::Inputs& inputs, std::vector<std::string> implied = {}) {
  if (inputs.velocity) implied.emplace_back("velocity from successive motions");
  if (inputs.time) implied.emplace_back("time by the device's clock");
  if (inputs.pressure) implied.emplace_back("pressure of the effects before");
  return implied.empty() ? "nothing but the position" : text::join(implied);
}

std::string implied_text(const scene::SceneObject& part, const PartSum& sum) {
  std::vector<std::string> implied;
  if (part.shape) {
    implied.emplace_back("depth and normal at the nearest point of the shape");
    if (sum.reach_m > 0) implied.push_back("distance above it, up to " + rounded(sum.reach_m * 1e3) + " mm");
  }
  return implied_text(sum.inputs, std::move(implied));
}

/// Warning about a size that is probably a mistake; empty for a plausible size.
std::string size_warning(double largest_m) {
  constexpr double kLeast_m = 1e-3;
  constexpr double kMost_m = 1;
  if (largest_m >= kLeast_m && largest_m <= kMost_m) return {};
  return kIndent + "warning: " +
         (largest_m > kMost_m ? "larger than 1 m for a hand; is a scale missing? (0.001 for mm)\n"
                              : "smaller than 1 mm for a hand; is the scale too small?\n");
}

/// Text of the bounding box along the scene's axes.
/// @param axes of the scene
std::string bounds_text(const Eigen::AlignedBox3d& bounds_m, Eigen::Index axes) {
  if (bounds_m.isEmpty() || !bounds_m.sizes().head(axes).allFinite()) return {};
  const auto list = [&](const scene::Point& point, const char* between, double unit) {
    std::string text;
    for (Eigen::Index i = 0; i < axes; ++i) text += (i == 0 ? "" : between) + rounded(unit * point[i]);
    return text;
  };
  return "  box:        [" + list(bounds_m.min(), ", ", 1) + "] to [" + list(bounds_m.max(), ", ", 1) + "] m,\n" +
         kIndent + list(bounds_m.sizes(), " x ", 1e3) + " mm\n" + size_warning(bounds_m.sizes().head(axes).maxCoeff());
}

/// @param bounds bounds_text of its shape @param points as of sum_of
std::string explain_part(const std::string& what, const scene::SceneObject& part, const std::string& bounds,
                         const scene::PartRendering& rendering, const RingingDevice& device,
                         const std::optional<MeasuredCost>& measured, std::size_t points = 1) {
  const PartSum sum = sum_of(part, points);
  std::string text = what + " '" + part.name + "'" + (part.shape ? ": " + part.shape_text : "") + "\n" + bounds;
  for (const scene::RequestedEffect& requested : part.effects) {
    text +=
        "  effect '" + requested.name + "'" + (requested.parameters.empty() ? "" : ": " + requested.parameters) + "\n";
    text += "    law:      " + requested.law + "\n";
  }
  text += "  implies:    " + implied_text(part, sum) + "\n";
  text += "  rendering:  " + scene::to_text(rendering) + "\n";
  text += "  cost:       " + cost_text(static_cast<double>(points) * predicted_cost_ns(part), measured) + "\n";
  text += "  memory:     " + bytes_text(sum.memory_bytes) + " shared by all, " + bytes_text(sum.state_bytes) +
          " for each client\n";
  return text + "  stability:  " + stability_text(ringing_of(part), device, kIndent) + "\n";
}

std::string explain_dynamic_model(const scene::SceneDynamicModel& dynamic_model, const scene::PartRendering& rendering,
                                  const RingingDevice& device, const std::optional<MeasuredCost>& measured) {
  const scene::DynamicModelFacts facts = dynamic_model.dynamic_model->facts();
  constexpr Eigen::Index kModelAxes = 3;
  std::string text = "dynamic model '" + dynamic_model.name + "': " + dynamic_model.text + "\n" +
                     bounds_text(facts.bounds_m, kModelAxes);
  for (const std::string& line : facts.lines) text += "  " + line + "\n";
  text += "  rendering:  " + scene::to_text(rendering) + "\n";
  text += "  implies:    " + implied_text(facts.inputs) + "\n";
  text += "  cost:       " + cost_text(predicted_cost_ns(facts), measured) + "\n";
  text += "  memory:     " + bytes_text(facts.memory_bytes) + " shared by all, " + bytes_text(facts.state_bytes) +
          " for each state\n";
  return text + "  stability:  " + stability_text(ringing_of(facts), device, kIndent) + "\n";
}

std::string sharing_text(const scene::Scene& scene) {
  if (scene.dynamic_models().empty()) return {};
  if (!scene.facts().shared) return "each client has dynamic models of its own\n";
  return "shared: up to " + std::to_string(scene.facts().clients_max) + " clients feel the same dynamic models\n";
}

std::string tool_text(const scene::Scene& scene) {
  const control::Vector& tool_m = scene.facts().tool_m;
  if (tool_m.rows() == 0) return {};
  const std::string tip =
      "tool: " + config::to_text(Eigen::Vector3d(tool_m), tool_m.rows()) + " m from the grip to its tip, ";
  const auto& tool = scene.facts().tool;
  if (!tool) return tip + "which touches, and turns a handle that shows torque\n";
  const char* const stability = tool->contact() == scene::ToolContact::constraint
                                    ? "contact is a constraint: as stiff as one point, however many touch\n"
                                    : "contact is a penalty: stability below is that of one point, and those that "
                                      "touch at once add up\n";
  return tip + "touches with " + std::to_string(tool->points().size()) + " points, all within " +
         rounded(1e3 * tool->reach_m()) + " mm of that;\n" + kIndent +
         "turns a handle that shows torque; one that does not tell its orientation touches nothing\n" + kIndent +
         stability;
}

std::string not_simulated_text(const scene::Scene& scene) {
  const bool has_tool = scene.facts().tool_m.rows() > 0;
  std::string text = "not simulated: " + std::string(has_tool ? "torques but those of the tool" : "torques");
  if (!scene.inputs().velocity) text += "; velocity (nothing needs it)";
  if (scene.dynamic_models().empty()) text += "; bodies and tissue (there are none)";
  if (!scene.facts().effects_not_requested.empty())
    text += "; effects that the scene does not ask for: " + text::join(scene.facts().effects_not_requested);
  return text + "\n";
}

std::string clients_text(const scene::SceneFacts& scene, double cost_ns) {
  if (scene.shared) {
    return ", " + rounded(scene.clients_max * cost_ns / kTick_ns * 100) + " % for all " +
           std::to_string(scene.clients_max);
  }
  // With more clients the network is the limit.
  if (cost_ns < 1e-3 * kTick_ns) return {};
  return "; at 1 kHz one core holds " + std::to_string(static_cast<int>(kTick_ns / cost_ns));
}

std::string accuracy_text(const scene::Scene& scene, bool measured) {
  const scene::AutoAccuracy* const accuracy = scene.accuracy();
  if (accuracy == nullptr) return {};
  std::string text = "accuracy auto: by the client's round trip, one of\n";
  for (const scene::AccuracyLevel& level : accuracy->levels) {
    text += "  " + accuracy->key + " = " + level.value + ": model " + rounded(100 * level.model_error) + " % off, " +
            time_text(level.step_s * 1e9) + " a motion " + (measured ? "measured" : "predicted") + "\n";
  }
  for (const bool locally : {false, true}) {
    text += locally ? "  locally     " : "  that is     ";
    for (const double round_trip_ms : {1, 5, 20, 50}) {
      text += (round_trip_ms > 1 ? ", " : "") +
              accuracy->best({.round_trip_s = round_trip_ms * 1e-3, .renders_locally = locally}).value + " behind " +
              rounded(round_trip_ms) + " ms";
    }
    text += "\n";
  }
  return text;
}

/// For copying into a command line: one option per line, so that no option is broken.
std::string options_text(const SuggestedHand& hand) {
  const std::string whole = to_options(hand);
  const std::size_t second = whole.find(" --", 1);
  if (second == std::string::npos || kIndent.size() + whole.size() <= text::kColumns) return whole + "\n";
  return whole.substr(0, second) + " \\\n" + kIndent + whole.substr(second + 1) + "\n";
}

std::string hand_text(const ExplainedHand& hand) {
  const auto& [suggested, trial] = hand;
  std::string text = "hand:         " + options_text(suggested) + kIndent +
                     (suggested.computed ? "computed from the scene" : "by the scene's author") + "; ";
  if (trial.starts_inside) return text + "warning: it starts inside an object\n";
  if (!trial.touched_s) {
    return text + "warning: it feels nothing within " + rounded(HandTrial::kLongest_s) + " s\n" + kIndent +
           "(tried in virtual time, without a network)\n";
  }
  text += "feels something after " + rounded(*trial.touched_s) + " s";
  return text + (trial.contacts > 1 ? ", with " + std::to_string(trial.contacts) + " contacts at once\n" : "\n");
}

std::string total_text(const scene::Scene& scene, const ExplainFacts& facts) {
  const double predicted_ns = predicted_cost_ns(scene);
  const auto measured = facts.calibration ? std::optional(facts.calibration->whole) : std::nullopt;
  const double cost_ns = measured ? measured->p99_ns : predicted_ns;
  std::string text = "total:        " + cost_text(predicted_ns, measured) +
                     " of the 1 ms of a tick: " + (measured ? "by the p99 " : "") + rounded(cost_ns / kTick_ns * 100) +
                     " % for each client" + clients_text(scene.facts(), cost_ns) + "\n";
  if (facts.answer_bytes > 0) {
    text += kIndent + std::to_string(facts.answer_bytes) + " bytes an answer, " +
            rounded(static_cast<double>(facts.answer_bytes)) + " kB/s to each client at 1 kHz\n";
  }
  if (scene.parts() < 2) return text;
  return text + kIndent + "all at one place: " + stability_text(ringing_of(scene), facts.device, kIndent) + "\n";
}

std::string summary_of(const scene::SceneObject& part) {
  std::string text = part.name;
  if (part.shape) text += " (" + part.shape_text.substr(0, part.shape_text.find(',')) + ")";
  text += ":";
  for (const scene::RequestedEffect& requested : part.effects) {
    text += " " + requested.name + (requested.parameters.empty() ? "" : " " + requested.parameters);
  }
  return text;
}

}  // namespace

std::string explain(const scene::Scene& scene, const ExplainFacts& facts) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(scene.facts().hash));
  std::string text =
      "scene '" + scene.facts().name + "' (hash " + hash + "): " + text::printable(scene.facts().description) + "\n";
  text += "devices: " + scene.accepted_degrees_of_freedom() + " degree" +
          (scene.facts().degrees_of_freedom == 1 ? "" : "s") + " of freedom\n" + tool_text(scene);
  text += "motion:       " +
          cost_text(scene::kMotion_ns, facts.calibration ? std::optional(facts.calibration->motion) : std::nullopt) +
          ", besides the parts below\n";
  const std::string refused = handover::why_refused(scene);
  std::size_t part = 0;
  const auto rendering_of = [&](std::size_t number) {
    const scene::PartRendering& rendering = scene.rendering_of_part(number);
    if (refused.empty() || rendering.how != scene::Rendering::at_client) return rendering;
    return scene::PartRendering{scene::Rendering::held, "clients refuse the scene: " + refused};
  };
  const auto measured = [&] { return part_alone(facts.calibration, part++); };
  const Eigen::Index axes = std::max(1, scene.facts().degrees_of_freedom);
  const auto& tool = scene.facts().tool;
  const std::size_t points = tool ? tool->points().size() : 1;
  for (const scene::SceneObject& object : scene.objects()) {
    const scene::PartRendering rendering = rendering_of(part);
    text += explain_part("object", object, bounds_text(object.shape->facts().bounds_m, axes), rendering, facts.device,
                         measured(), points);
  }
  for (const scene::SceneObject& field : scene.fields()) {
    const scene::PartRendering rendering = rendering_of(part);
    text += explain_part("field", field, "", rendering, facts.device, measured());
  }
  for (const scene::SceneDynamicModel& dynamic_model : scene.dynamic_models()) {
    const scene::PartRendering rendering = rendering_of(part);
    text += explain_dynamic_model(dynamic_model, rendering, facts.device, measured());
  }
  if (part == 0) text += "no objects: every force is zero\n";
  text += accuracy_text(scene, facts.calibration.has_value()) + sharing_text(scene);
  if (facts.hand) text += hand_text(*facts.hand);
  return text + not_simulated_text(scene) + total_text(scene, facts);
}

std::string summary(const scene::Scene& scene) {
  std::string text;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const scene::SceneObject& part : *parts) text += (text.empty() ? "" : "; ") + summary_of(part);
  }
  for (const scene::SceneDynamicModel& dynamic_model : scene.dynamic_models()) {
    text += (text.empty() ? "" : "; ") + dynamic_model.name + " (" + dynamic_model.text + ")";
  }
  return text.empty() ? "no objects: every force is zero" : text;
}

}  // namespace forcebound::server
