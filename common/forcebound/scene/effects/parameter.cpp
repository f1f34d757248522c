#include "forcebound/scene/effects/parameter.hpp"

#include <cmath>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {

std::string range_text(const NumberParameter& parameter) {
  std::string text;
  if (std::isfinite(parameter.least)) text = (parameter.least_excluded ? "> " : ">= ") + text::to_text(parameter.least);
  if (std::isfinite(parameter.most)) text += (text.empty() ? "<= " : " and <= ") + text::to_text(parameter.most);
  return text.empty() ? "any" : text;
}

std::string_view key_of(const EffectParameter& parameter) noexcept {
  return std::visit([](const auto& any) { return any.key; }, parameter);
}

bool has_preset(const EffectParameter& parameter) noexcept {
  if (const auto* number = std::get_if<NumberParameter>(&parameter)) return number->preset.has_value();
  if (const auto* point = std::get_if<PointParameter>(&parameter)) return point->preset.has_value();
  return true;
}

const EffectValues::Value& EffectValues::at(std::string_view key) const {
  const auto found = values_.find(key);
  if (found == values_.end())
    throw std::out_of_range("an effect reads '" + std::string(key) + "', which it has not declared");
  return found->second;
}

}  // namespace forcebound::scene
