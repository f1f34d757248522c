#include "forcebound/scene/effects/waveform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace forcebound::scene {

const std::vector<std::string_view>& waveform_names() {
  static const std::vector<std::string_view> kNames{"sine", "square", "triangle", "sawtooth"};
  return kNames;
}

Waveform waveform_from(std::string_view name) {
  const auto& names = waveform_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument("unknown waveform '" + std::string(name) + "'");
  return static_cast<Waveform>(found - names.begin());
}

double value_of(Waveform waveform, double turns) noexcept {
  const double phase = turns - std::floor(turns);
  switch (waveform) {
    case Waveform::sine:
      return std::sin(2 * std::numbers::pi * phase);
    case Waveform::square:
      return phase < 0.5 ? 1 : -1;
    case Waveform::triangle:
      return 1 - 4 * std::abs(phase - 0.25 - std::floor(phase + 0.25));
    case Waveform::sawtooth:
      return 2 * (phase - std::floor(phase + 0.5));
  }
  return 0;
}

}  // namespace forcebound::scene
