#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// A number that a scene gives an effect, with its unit in the key. What is not finite or outside is refused at load.
struct NumberParameter {
  std::string_view key;
  std::string_view meaning{};
  std::optional<double> preset{};  ///< value where the scene is silent; none: the scene must say
  double least = -std::numeric_limits<double>::infinity();
  bool least_excluded = false;
  double most = std::numeric_limits<double>::infinity();
};

/// "> 0 and <= 100", "any" where there is no bound.
std::string range_text(const NumberParameter& parameter);

/// A place, a velocity or a force, or a direction of any length but zero; as many numbers as the scene has axes.
struct PointParameter {
  std::string_view key;
  std::string_view meaning{};
  std::optional<Point> preset{};
  bool is_direction = false;  ///< the effect gets it with length one
};

/// One of several words; where the scene is silent, the first.
struct ChoiceParameter {
  std::string_view key;
  std::string_view meaning{};
  std::vector<std::string_view> choices;
};

using EffectParameter = std::variant<NumberParameter, PointParameter, ChoiceParameter>;

std::string_view key_of(const EffectParameter& parameter) noexcept;

/// Whether a scene may be silent about it.
bool has_preset(const EffectParameter& parameter) noexcept;

/// What a scene said of one effect: a value for each of its parameters, in range.
class EffectValues {
 public:
  using Value = std::variant<double, Point, std::string>;

  EffectValues() = default;
  EffectValues(std::initializer_list<std::pair<const std::string, Value>> values) : values_(values) {}

  void set(std::string_view key, Value value) { values_.insert_or_assign(std::string(key), std::move(value)); }

  /// @throws std::out_of_range, std::bad_variant_access if the effect has no such parameter: its author's mistake.
  [[nodiscard]] double number(std::string_view key) const { return std::get<double>(at(key)); }
  [[nodiscard]] Point point(std::string_view key) const { return std::get<Point>(at(key)); }
  [[nodiscard]] const std::string& choice(std::string_view key) const { return std::get<std::string>(at(key)); }

 private:
  [[nodiscard]] const Value& at(std::string_view key) const;

  std::map<std::string, Value, std::less<>> values_;
};

}  // namespace forcebound::scene
