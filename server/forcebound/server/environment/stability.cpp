#include "forcebound/server/environment/stability.hpp"

#include <algorithm>

#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

using text::rounded;

constexpr double kPeriod_s = 1e-3;
// As deep as a hand presses.
constexpr double kDeep_m = 0.01;

std::string margin_text(const Ringing& part, const RingingDevice& device, double delay_s) {
  return rounded(device.damping_N_s_per_m / part.damping_needed_N_s_per_m(delay_s));
}

}  // namespace

double Ringing::damping_needed_N_s_per_m(double delay_s, double depth_m) const noexcept {
  return (stiffness_N_per_m + stiffening_N_per_m2 * depth_m) * (kPeriod_s / 2 + age_s + delay_s) + damping_N_s_per_m;
}

Ringing Ringing::with(const Ringing& other) const noexcept {
  return {.stiffness_N_per_m = stiffness_N_per_m + other.stiffness_N_per_m,
          .stiffening_N_per_m2 = stiffening_N_per_m2 + other.stiffening_N_per_m2,
          .damping_N_s_per_m = damping_N_s_per_m + other.damping_N_s_per_m,
          .age_s = std::max(age_s, other.age_s),
          .drives = drives || other.drives};
}

Ringing ringing_of(const scene::SceneObject& part) {
  Ringing sum;
  for (const scene::RequestedEffect& requested : part.effects) {
    const scene::EffectFacts effect = requested.effect->facts();
    sum = sum.with({.stiffness_N_per_m = effect.stiffness_N_per_m,
                    .stiffening_N_per_m2 = effect.stiffening_N_per_m2,
                    .damping_N_s_per_m = effect.damping_N_s_per_m,
                    .drives = effect.drives});
  }
  return sum;
}

Ringing ringing_of(const scene::DynamicModelFacts& facts) {
  return {
      .stiffness_N_per_m = facts.stiffness_N_per_m, .damping_N_s_per_m = facts.damping_N_s_per_m, .age_s = facts.age_s};
}

Ringing ringing_of(const scene::Scene& scene) {
  Ringing sum;
  for (const auto* parts : {&scene.objects(), &scene.fields()}) {
    for (const scene::SceneObject& part : *parts) sum = sum.with(ringing_of(part));
  }
  for (const scene::SceneDynamicModel& dynamic_model : scene.dynamic_models())
    sum = sum.with(ringing_of(dynamic_model.dynamic_model->facts()));
  return sum;
}

std::string stability_text(const Ringing& part, const RingingDevice& device, const std::string& indent) {
  const std::string drives = "drives the device with energy of its own, which a law bounds and no damping does";
  const double needed = part.damping_needed_N_s_per_m(0);
  if (!(needed > 0)) return part.drives ? drives : "neither stiffness nor damping: nothing that could ring";
  std::string text = part.drives ? drives + "\n" + indent + "apart from that energy " : "";
  text += "passive without a law on a device with damping above " + rounded(needed) + " N s/m";
  if (part.stiffening_N_per_m2 > 0) {
    text += ", " + rounded(part.damping_needed_N_s_per_m(0, kDeep_m)) + " at a depth of " + rounded(kDeep_m * 1e3) +
            " mm, the more the deeper";
  }
  text += " (b > K " + std::string(part.age_s > 0 ? "(T/2 + age)" : "T/2") + " + B: K " +
          rounded(part.stiffness_N_per_m) + " N/m, B " + rounded(part.damping_N_s_per_m) + " N s/m, T 1 ms" +
          (part.age_s > 0 ? ", age " + rounded(part.age_s * 1e3) + " ms" : "") + ")";
  text += "\n" + indent + "margin " + margin_text(part, device, 0) + " for a device of " +
          rounded(device.damping_N_s_per_m) + " N s/m";
  if (device.round_trip_s > 0) {
    text += ", " + margin_text(part, device, device.round_trip_s) + " behind a round trip of " +
            rounded(device.round_trip_s * 1e3) + " ms";
  }
  return text;
}

}  // namespace forcebound::server
