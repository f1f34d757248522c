#include "forcebound/scene/effects/vibration.hpp"

#include "forcebound/scene/effects/waveform.hpp"

namespace forcebound::scene {
namespace {

class Vibration final : public Effect {
 public:
  explicit Vibration(const Values& values)
      : amplitude_N_(values.number("amplitude_N")),
        frequency_Hz_(values.number("frequency_Hz")),
        phase_turns_(values.number("phase_turns")),
        along_normal_(values.choice("along") == "normal"),
        axis_(values.point("axis")),
        waveform_(waveform_from(values.choice("waveform"))) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const double value = value_of(waveform_, frequency_Hz_ * probe.time_s + phase_turns_);
    reaction.force_N += amplitude_N_ * value * (along_normal_ ? probe.normal : axis_);
  }

  EffectFacts facts() const override {
    return {.inputs = {.time = true}, .drives = true, .fades_without_server = true, .cost_ns = 15};
  }

 private:
  double amplitude_N_;
  double frequency_Hz_;
  double phase_turns_;
  bool along_normal_;
  Point axis_;
  Waveform waveform_;
};

}  // namespace

EffectKind vibration_effect() {
  return {
      .name = "vibration",
      .purpose = "vibrates while it is touched",
      .law = "f = A w(frequency t + phase) u",
      .parameters =
          {NumberParameter{.key = "amplitude_N", .meaning = "A, from mean to peak", .least = 0, .most = 1e6},
           NumberParameter{.key = "frequency_Hz",
                           .meaning = "at most half of the motions' rate of 1 kHz",
                           .least = 0,
                           .most = kFrequency_Hz_most},
           NumberParameter{.key = "phase_turns", .meaning = "phase at the start, in periods", .preset = 0},
           ChoiceParameter{
               .key = "along", .meaning = "what u is: out of the surface, or the axis", .choices = {"normal", "axis"}},
           PointParameter{
               .key = "axis", .meaning = "u, where along is \"axis\"", .preset = Point::UnitX(), .is_direction = true},
           ChoiceParameter{.key = "waveform", .meaning = "w, the shape of the wave", .choices = waveform_names()}},
      .make = [](const Values& values) { return std::make_unique<Vibration>(values); }};
}

}  // namespace forcebound::scene
