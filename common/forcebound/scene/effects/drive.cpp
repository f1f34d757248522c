#include "forcebound/scene/effects/drive.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace forcebound::scene {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kDutyPreset = 0.5;
constexpr double kNotGiven = 0;

using Wave = double (*)(double part, double duty) noexcept;

double sine(double part, double) noexcept { return std::sin(2 * std::numbers::pi * part); }
double square(double part, double duty) noexcept { return part < duty ? 1 : -1; }
double triangle(double part, double) noexcept { return part < 0.75 ? 1 - std::abs(4 * part - 1) : 4 * part - 4; }
double sawtooth(double part, double) noexcept { return part < 0.5 ? 2 * part : 2 * part - 2; }
double pulse(double part, double duty) noexcept { return part < duty ? 1 : 0; }

Wave wave_of(std::string_view waveform) {
  if (waveform == "square") return square;
  if (waveform == "triangle") return triangle;
  if (waveform == "sawtooth") return sawtooth;
  if (waveform == "pulse") return pulse;
  return sine;
}

class Drive final : public Effect {
 public:
  explicit Drive(const Values& values)
      : wave_(wave_of(values.choice("waveform"))),
        amplitude_N_(values.number("amplitude_N") * values.point("direction")),
        frequency_Hz_(values.number("frequency_Hz")),
        phase_(values.number("phase_rad") / (2 * std::numbers::pi)),
        start_s_(values.number("start_s")),
        duration_s_(values.number("duration_s")),
        duty_(values.number("duty")) {
    const std::string& waveform = values.choice("waveform");
    if (duty_ != kDutyPreset && waveform != "square" && waveform != "pulse") {
      throw std::invalid_argument("duty is for square and pulse, not for " + waveform);
    }
    const double end_Hz = values.number("frequency_end_Hz");
    if ((waveform == "chirp") != (end_Hz != kNotGiven)) {
      throw std::invalid_argument(waveform == "chirp"
                                      ? "'frequency_end_Hz' is missing: a chirp goes from frequency_Hz to it"
                                      : "frequency_end_Hz is for chirp, not for " + waveform);
    }
    if (waveform != "chirp") return;
    if (duration_s_ == kForever) throw std::invalid_argument("'duration_s' is missing: a chirp needs an end");
    half_rise_Hz_per_s_ = (end_Hz - frequency_Hz_) / (2 * duration_s_);
  }

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const double elapsed_s = probe.time_s - start_s_;
    if (elapsed_s < 0 || elapsed_s >= duration_s_) return;
    const double cycles = (frequency_Hz_ + half_rise_Hz_per_s_ * elapsed_s) * elapsed_s + phase_;
    reaction.force_N += wave_(cycles - std::floor(cycles), duty_) * amplitude_N_;
  }

  EffectFacts facts() const override {
    return {.inputs = {.time = true}, .drives = true, .fades_without_server = true, .cost_ns = 20};
  }

 private:
  Wave wave_;
  Point amplitude_N_;
  double frequency_Hz_;
  double half_rise_Hz_per_s_ = 0;
  double phase_;  ///< cycles
  double start_s_;
  double duration_s_;
  double duty_;
};

std::vector<Parameter> parameters() {
  return {ChoiceParameter{.key = "waveform",
                          .meaning = "s, the shape of the wave",
                          .choices = {"sine", "square", "triangle", "sawtooth", "pulse", "chirp"}},
          PointParameter{.key = "direction", .meaning = "e, where it pushes to", .is_direction = true},
          NumberParameter{.key = "amplitude_N", .meaning = "A, from mean to peak", .least = 0, .most = 1e6},
          positive_number("frequency_Hz", "f0, how often; of a chirp, at its start", 1e6),
          positive_number("frequency_end_Hz", "f1, of a chirp, at its end", 1e6, kNotGiven),
          NumberParameter{.key = "phase_rad", .meaning = "phase at t0", .preset = 0, .least = -1e6, .most = 1e6},
          NumberParameter{.key = "start_s", .meaning = "t0, after the first motion", .preset = 0, .least = 0},
          NumberParameter{.key = "duration_s", .meaning = "D, duration", .preset = kForever, .least = 1e-6},
          positive_number("duty", "share of the period for which a square or pulse is on", 1, kDutyPreset)};
}

}  // namespace

EffectKind drive_effect() {
  return {.name = "drive",
          .purpose = "moves the device in time: a wave, a tremor, a push",
          .law = "f = A e s(f0 (t - t0) + phase/(2 pi)) while t0 <= t < t0 + D",
          .place = EffectPlace::space,
          .parameters = parameters(),
          .make = [](const Values& values) { return std::make_unique<Drive>(values); }};
}

}  // namespace forcebound::scene
