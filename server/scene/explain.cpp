#include "forcebound/server/scene/explain.hpp"

#include <algorithm>
#include <cstdio>

#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr double kPeriod_s = 1e-3;

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string time_text(double ns) {
  if (ns < 1e3) return rounded(ns) + " ns";
  return ns < 1e6 ? rounded(ns * 1e-3) + " us" : rounded(ns * 1e-6) + " ms";
}

std::string bytes_text(std::size_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size < 10e3) return std::to_string(bytes) + " bytes";
  return size < 10e6 ? rounded(size * 1e-3) + " kB" : rounded(size * 1e-6) + " MB";
}

std::string cost_text(double predicted_ns, const MeasuredCost* measured) {
  std::string text = time_text(predicted_ns) + " predicted";
  if (measured != nullptr) {
    text += ", " + time_text(measured->median_ns) + " measured (p99 " + time_text(measured->p99_ns) + ")";
  }
  return text;
}

/// What a part costs and needs, summed over its effects.
struct PartSum {
  Inputs inputs{};
  double cost_ns = 0;
  double stiffness_N_per_m = 0;
  std::size_t state_bytes = 0;
  std::size_t memory_bytes = 0;
  double reach_m = 0;
};

PartSum sum_of(const SceneObject& part) {
  PartSum sum;
  if (part.shape) {
    const ShapeFacts shape = part.shape->facts();
    sum = {.cost_ns = shape.cost_ns, .state_bytes = shape.state_bytes, .memory_bytes = shape.memory_bytes};
  }
  for (const RequestedEffect& requested : part.effects) {
    const EffectFacts effect = requested.effect->facts();
    sum.inputs = sum.inputs.with(effect.inputs);
    sum.cost_ns += effect.cost_ns;
    sum.stiffness_N_per_m += effect.stiffness_N_per_m;
    sum.state_bytes += effect.state_bytes;
    sum.reach_m = std::max(sum.reach_m, effect.reach_m);
  }
  return sum;
}

std::string implied_text(const SceneObject& part, const PartSum& sum) {
  std::vector<std::string> implied;
  if (part.shape) {
    implied.emplace_back("depth and normal at the nearest point of the shape");
    if (sum.reach_m > 0) implied.push_back("distance above it, up to " + rounded(sum.reach_m * 1e3) + " mm");
  }
  if (sum.inputs.velocity) implied.emplace_back("velocity from successive motions");
  if (sum.inputs.time) implied.emplace_back("time by the device's clock");
  if (sum.inputs.pressure) implied.emplace_back("pressure of the effects before");
  return implied.empty() ? "nothing but the position" : text::join(implied);
}

std::string stability_text(double stiffness_N_per_m) {
  if (!(stiffness_N_per_m > 0)) return "no stiffness: nothing that could ring";
  return text::to_text(stiffness_N_per_m) + " N/m is passive without a law on a device with damping above " +
         text::to_text(stiffness_N_per_m * kPeriod_s / 2) + " N s/m at 1 kHz and no delay (b > K T/2)";
}

std::string explain_part(const std::string& what, const SceneObject& part, const MeasuredCost* measured) {
  const PartSum sum = sum_of(part);
  std::string text = what + " '" + part.name + "'" + (part.shape ? ": " + part.shape_text : "") + "\n";
  for (const RequestedEffect& requested : part.effects) {
    text +=
        "  effect '" + requested.name + "'" + (requested.parameters.empty() ? "" : ": " + requested.parameters) + "\n";
    text += "    law:      " + requested.law + "\n";
  }
  text += "  implies:    " + implied_text(part, sum) + "\n";
  text += "  cost:       " + cost_text(sum.cost_ns, measured) + "\n";
  text += "  memory:     " + bytes_text(sum.memory_bytes) + " shared by all, " + bytes_text(sum.state_bytes) +
          " for each client\n";
  return text + "  stability:  " + stability_text(sum.stiffness_N_per_m) + "\n";
}

std::string explain_medium(const SceneMedium& medium, const MeasuredCost* measured) {
  const MediumFacts facts = medium.medium->facts();
  std::string text = "medium '" + medium.name + "': " + medium.text + "\n";
  for (const std::string& line : facts.lines) text += "  " + line + "\n";
  text += "  implies:    velocity from successive motions, and the time between them\n";
  text += "  cost:       " + cost_text(facts.cost_ns, measured) + "\n";
  text += "  memory:     " + bytes_text(facts.memory_bytes) + " shared by all, " + bytes_text(facts.state_bytes) +
          " for each state\n";
  return text + "  stability:  " + stability_text(facts.stiffness_N_per_m) + "\n";
}

std::string sharing_text(const Scene& scene) {
  if (scene.media().empty()) return {};
  if (!scene.facts().shared) return "each client has media of its own\n";
  return "shared: up to " + std::to_string(scene.facts().clients_max) + " clients feel the same media\n";
}

std::string not_simulated_text(const Scene& scene) {
  std::string text = "not simulated: torques";
  if (scene.media().empty()) {
    if (!scene.plan().inputs().velocity) text += "; velocity (no effect needs it)";
    text += "; bodies and tissue (there are none)";
  }
  if (!scene.facts().effects_not_requested.empty())
    text += "; effects nobody asked for: " + text::join(scene.facts().effects_not_requested);
  return text + "\n";
}

std::string total_text(const Scene& scene, const ExplainFacts& facts) {
  double predicted_ns = 0;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const SceneObject& part : *parts) predicted_ns += sum_of(part).cost_ns;
  }
  for (const SceneMedium& medium : scene.media()) predicted_ns += medium.medium->facts().cost_ns;
  const MeasuredCost* measured = facts.calibration ? &facts.calibration->whole : nullptr;
  const double cost_ns = measured != nullptr ? measured->p99_ns : predicted_ns;
  std::string text = "total:        " + cost_text(predicted_ns, measured) +
                     " of the 1 ms of a tick: " + rounded(cost_ns / 1e6 * 100) + " % for each client\n";
  if (facts.answer_bytes > 0) {
    text += "              " + std::to_string(facts.answer_bytes) + " bytes an answer, " +
            rounded(static_cast<double>(facts.answer_bytes)) + " kB/s to each client at 1 kHz\n";
  }
  return text;
}

std::string summary_of(const SceneObject& part) {
  std::string text = part.name;
  if (part.shape) text += " (" + part.shape_text.substr(0, part.shape_text.find(',')) + ")";
  text += ":";
  for (const RequestedEffect& requested : part.effects) {
    text += " " + requested.name + (requested.parameters.empty() ? "" : " " + requested.parameters);
  }
  return text;
}

}  // namespace

std::string explain(const Scene& scene, const ExplainFacts& facts) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(scene.facts().hash));
  std::string text = "scene '" + scene.facts().name + "' (hash " + hash + "): " + scene.facts().description + "\n";
  text += "devices: " + scene.accepted_degrees_of_freedom() + " degrees of freedom\n";
  std::size_t part = 0;
  const auto measured = [&] {
    const std::size_t now = part++;
    return facts.calibration ? &facts.calibration->parts.at(now) : nullptr;
  };
  for (const SceneObject& object : scene.objects()) text += explain_part("object", object, measured());
  for (const SceneObject& field : scene.fields()) text += explain_part("field", field, measured());
  for (const SceneMedium& medium : scene.media()) text += explain_medium(medium, measured());
  if (part == 0) text += "no objects: every force is zero\n";
  text += sharing_text(scene);
  return text + not_simulated_text(scene) + total_text(scene, facts);
}

std::string summary(const Scene& scene) {
  std::string text;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const SceneObject& part : *parts) text += (text.empty() ? "" : "; ") + summary_of(part);
  }
  for (const SceneMedium& medium : scene.media()) {
    text += (text.empty() ? "" : "; ") + medium.name + " (" + medium.text + ")";
  }
  return text.empty() ? "nothing: every force is zero" : text;
}

}  // namespace forcebound::server
