#pragma once

#include <memory>
#include <string>

#include "forcebound/scene/registry.hpp"
#include "forcebound/server/environment/scene_parser.hpp"

/// Effects for tests of the plan.
namespace forcebound::test {

/// Counts its motions in its state, and pushes along x with that many newtons; uses the time.
class ClockEffect final : public scene::Effect {
 public:
  void act(const scene::Probe& probe, std::byte* state, scene::Reaction& reaction) const noexcept override {
    auto& count = scene::state_as<double>(state);
    count += 1;
    reaction.force_N.x() += count;
    reaction.force_N.y() += probe.time_s;
    reaction.force_N.z() += probe.interval_s;
  }
  [[nodiscard]] scene::EffectFacts facts() const override {
    return {.inputs = {.time = true}, .state_bytes = sizeof(double)};
  }
};

/// Pushes along x with the pressure, and counts its calls in its state.
class PressedEffect final : public scene::Effect {
 public:
  void act(const scene::Probe& probe, std::byte* state, scene::Reaction& reaction) const noexcept override {
    reaction.force_N.x() += probe.pressure_N;
    reaction.force_N.y() += scene::state_as<double>(state)++;
  }
  [[nodiscard]] scene::EffectFacts facts() const override {
    return {.inputs = {.pressure = true}, .state_bytes = sizeof(double)};
  }
};

/// Within 10 mm above the surface too: pulls with 1 N along x, and counts in y.
class NearEffect final : public scene::Effect {
 public:
  void act(const scene::Probe&, std::byte* state, scene::Reaction& reaction) const noexcept override {
    reaction.force_N += scene::Point(1, scene::state_as<double>(state)++, 0);
  }
  [[nodiscard]] scene::EffectFacts facts() const override { return {.state_bytes = sizeof(double), .reach_m = 0.01}; }
};

/// Steeper than a drive that ships: pulls away from z = 0 with 1000 N/m and 1 N along x, and fades without a server.
class LeverEffect final : public scene::Effect {
 public:
  void act(const scene::Probe& probe, std::byte*, scene::Reaction& reaction) const noexcept override {
    reaction.force_N += scene::Point(1, 0, 1000 * probe.position_m.z());
  }
  [[nodiscard]] scene::EffectFacts facts() const override {
    return {.stiffness_N_per_m = 1000, .drives = true, .fades_without_server = true};
  }
};

template <class Effect>
scene::EffectKind own_effect(std::string_view name, scene::EffectPlace place) {
  return {.name = name, .purpose = "for tests", .law = "its own", .place = place, .make = [](const scene::Values&) {
            return std::make_unique<Effect>();
          }};
}

/// A scene of three axes with these parts; `clock`, `lever`, `pressed` and `near` are registered beside the shipped
/// effects.
inline std::shared_ptr<const scene::Scene> scene_with_own_effects(const std::string& parts) {
  scene::Registry registry = scene::Registry::standard();
  registry.add(own_effect<ClockEffect>("clock", scene::EffectPlace::space));
  registry.add(own_effect<LeverEffect>("lever", scene::EffectPlace::space));
  registry.add(own_effect<PressedEffect>("pressed", scene::EffectPlace::surface));
  registry.add(own_effect<NearEffect>("near", scene::EffectPlace::surface));
  return server::parse_scene("[scene]\nname = 'own'\ndescription = ''\ndegrees_of_freedom = 3\n" + parts, "own.toml",
                             registry);
}

/// The object `name`, everything below z = 0.
inline std::string table(const std::string& name, const std::string& effects) {
  const bool pushes = effects.find("'surface'") != std::string::npos;
  return "[[object]]\nname = '" + name +
         "'\nshape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }\neffects = [" + effects +
         "]\n" + (pushes ? "surface = { stiffness_N_per_m = 1000 }\n" : "");
}

}  // namespace forcebound::test
