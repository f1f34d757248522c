#include "forcebound/server/scene/explain.hpp"

#include <cstdio>

#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

std::string explain_object(const SceneObject& object) {
  std::string text = "object '" + object.name + "': " + object.shape_text + "\n";
  for (const RequestedEffect& requested : object.effects) {
    text += "  effect '" + requested.name + "': " + requested.parameters + "\n";
    text += "    law:     " + requested.law + "\n";
    text += "    implies: depth and normal at the nearest point of the shape";
    text += requested.effect->facts().inputs.velocity ? "; velocity from successive motions\n" : "\n";
  }
  return text;
}

}  // namespace

std::string explain(const Scene& scene) {
  const SceneFacts& facts = scene.facts();
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(facts.hash));
  std::string text = "scene '" + facts.name + "' (hash " + hash + "): " + facts.description + "\n";
  text += "devices: " + scene.accepted_degrees_of_freedom() + " degrees of freedom\n";
  for (const SceneObject& object : scene.objects()) text += explain_object(object);
  if (scene.objects().empty()) text += "no objects: every force is zero\n";

  text += "not simulated: torques";
  if (!scene.plan().inputs().velocity) text += "; velocity (no effect needs it)";
  if (!facts.effects_not_requested.empty())
    text += "; effects nobody asked for: " + text::join(facts.effects_not_requested);
  return text + "\n";
}

std::string summary(const Scene& scene) {
  std::string text;
  for (const SceneObject& object : scene.objects()) {
    text += (text.empty() ? "" : "; ") + object.name + " (" + object.shape_text.substr(0, object.shape_text.find(',')) +
            "):";
    for (const RequestedEffect& requested : object.effects) text += " " + requested.name + " " + requested.parameters;
  }
  return text.empty() ? "nothing: every force is zero" : text;
}

}  // namespace forcebound::server
