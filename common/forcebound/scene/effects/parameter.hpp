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

/// A number that a scene gives an effect, with its unit in the key. Values not finite or out of range are refused at
/// load.
struct NumberParameter {
  std::string_view key;
  std::string_view meaning{};
  std::optional<double> preset{};  ///< default; none: the scene must give a value
  double least = -std::numeric_limits<double>::infinity();
  bool least_excluded = false;
  double most = std::numeric_limits<double>::infinity();
};

/// "> 0 and <= 100", "any" where there is no bound.
std::string range_text(const NumberParameter& parameter);

/// A place, a velocity or a force, or a direction of any length but zero; one number per axis of the scene.
struct PointParameter {
  std::string_view key;
  std::string_view meaning{};
  std::optional<Point> preset{};
  bool is_direction = false;  ///< the effect gets it with length one
};

/// One of several words; the default is the first.
struct ChoiceParameter {
  std::string_view key;
  std::string_view meaning{};
  std::vector<std::string_view> choices;
};

using EffectParameter = std::variant<NumberParameter, PointParameter, ChoiceParameter>;

std::string_view key_of(const EffectParameter& parameter) noexcept;

/// Whether a scene may leave it out.
bool has_preset(const EffectParameter& parameter) noexcept;

/// The parameters of one effect in a scene: a value in range for each.
class EffectValues {
 public:
  using Value = std::variant<double, Point, std::string>;

  EffectValues() = default;
  EffectValues(std::initializer_list<std::pair<const std::string, Value>> values) : values_(values) {}

  void set(std::string_view key, Value value) { values_.insert_or_assign(std::string(key), std::move(value)); }

  /// @throws std::out_of_range, std::bad_variant_access if the effect has not declared such a parameter: a bug in the
  /// effect.
  [[nodiscard]] double number(std::string_view key) const { return std::get<double>(at(key)); }
  [[nodiscard]] Point point(std::string_view key) const { return std::get<Point>(at(key)); }
  [[nodiscard]] const std::string& choice(std::string_view key) const { return std::get<std::string>(at(key)); }

 private:
  [[nodiscard]] const Value& at(std::string_view key) const;

  std::map<std::string, Value, std::less<>> values_;
};

}  // namespace forcebound::scene
