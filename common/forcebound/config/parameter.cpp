#include "forcebound/config/parameter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::config {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kNameBytesMax = 64;

[[noreturn]] void refuse(std::string_view key, const std::string& must_be, const std::string& got) {
  throw ValueError(key, std::string(key) + " must be " + must_be + ", got " + got);
}

std::string quoted(std::string_view word) { return "`\"" + std::string(word) + "\"`"; }

std::string range_text(const NumberParameter& number) {
  std::string text;
  if (std::isfinite(number.least)) text = (number.least_excluded ? "> " : ">= ") + text::to_text(number.least);
  if (std::isfinite(number.most)) text += (text.empty() ? "<= " : " and <= ") + text::to_text(number.most);
  return text.empty() ? "any" : text;
}

std::string bounds_text(const NumberParameter& number) {
  return "from " + text::to_text(number.least) + " to " + text::to_text(number.most);
}

bool has_bounds(const NumberParameter& number) { return std::isfinite(number.least) || std::isfinite(number.most); }

bool is_above_least(const NumberParameter& number, double value) {
  return number.least_excluded ? value > number.least : value >= number.least;
}

bool is_in_range(const NumberParameter& number, double value) {
  return is_above_least(number, value) && value <= number.most;
}

bool is_whole(double value) { return value == std::floor(value); }

// What is accepted, in words.

std::string words(const NumberParameter& number) {
  return number.whole ? "a whole number " + bounds_text(number) : range_text(number);
}

std::string words(const PointParameter& point) {
  if (!point.accepted.empty()) return std::string(point.accepted);
  if (point.is_direction) return "a direction";
  if (point.each.whole) return "a list of whole numbers " + bounds_text(point.each);
  if (point.each.least == -point.each.most && has_bounds(point.each)) return "a point " + bounds_text(point.each);
  return has_bounds(point.each) ? "a list of numbers, each " + range_text(point.each) : "a point";
}

std::string words(const ChoiceParameter& choice) {
  std::vector<std::string> words;
  words.reserve(choice.choices.size());
  for (const std::string_view word : choice.choices) words.push_back(quoted(word));
  return text::join(words);
}

std::string words(const FlagParameter&) { return "`true` or `false`"; }

std::string words(const TextParameter& text) {
  if (!text.accepted.empty()) return std::string(text.accepted);
  if (text.form == TextParameter::Form::name)
    return "1 to " + std::to_string(kNameBytesMax) + " bytes without control characters";
  return text.form == TextParameter::Form::file ? "a path within the scene's folder" : "text";
}

std::string words(const auto& other) { return std::string(other.accepted); }

// The preset in words.

std::string words_of_preset(const NumberParameter& number) {
  if (!number.preset || !number.absent.empty()) return std::string(number.absent);
  if (*number.preset == kInfinity) return "no limit";
  return is_above_least(number, *number.preset) ? text::to_text(*number.preset) : "not given";
}

std::string words_of_preset(const PointParameter& point) {
  if (!point.preset) return {};
  return point.preset->minCoeff() == kInfinity ? "no limit" : to_text(*point.preset);
}

std::string words_of_preset(const ChoiceParameter& choice) {
  return choice.absent.empty() ? quoted(choice.choices.front()) : std::string(choice.absent);
}

std::string words_of_preset(const FlagParameter& flag) { return flag.preset ? "`true`" : "`false`"; }

std::string words_of_preset(const auto& other) { return std::string(other.absent); }

std::optional<Value> preset_of(const NumberParameter& number) {
  return number.preset ? std::optional<Value>(*number.preset) : std::nullopt;
}

std::optional<Value> preset_of(const PointParameter& point) {
  return point.preset ? std::optional<Value>(*point.preset) : std::nullopt;
}

std::optional<Value> preset_of(const ChoiceParameter& choice) {
  return choice.absent.empty() ? std::optional<Value>(std::string(choice.choices.front())) : std::nullopt;
}

std::optional<Value> preset_of(const FlagParameter& flag) { return flag.preset; }

std::optional<Value> preset_of(const auto&) { return std::nullopt; }

// Checks of given values.

Value accept(const NumberParameter& number, double value) {
  if (!std::isfinite(value)) refuse(number.key, "a finite number", text::to_text(value));
  if (!is_in_range(number, value) || (number.whole && !is_whole(value))) {
    refuse(number.key, words(number), text::to_text(value));
  }
  return value;
}

/// The given numbers, on the scene's axes.
std::string as_given(const PointParameter& point, const Eigen::Vector3d& value) {
  const bool has_rest = point.rest == kInfinity;
  return to_text(value, has_rest ? std::ranges::count_if(value, [](double x) { return std::isfinite(x); }) : 3);
}

Value accept(const PointParameter& point, const Eigen::Vector3d& value) {
  const auto is_given = [&](double number) { return std::isfinite(number) || number == point.rest; };
  if (!std::ranges::all_of(value, is_given)) refuse(point.key, "finite", to_text(value));
  if (point.is_direction) {
    if (value.isZero(0)) throw ValueError(point.key, std::string(point.key) + " must not be zero");
    // A unit vector is returned unchanged, bit for bit.
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
    return std::abs(value.squaredNorm() - 1) <= kRounding ? value : Eigen::Vector3d(value.stableNormalized());
  }
  const NumberParameter& each = point.each;
  const auto fits = [&](double number) {
    const bool is_rest = std::isinf(number) && number == point.rest;
    return is_rest || (is_in_range(each, number) && (!each.whole || is_whole(number)));
  };
  if (!std::ranges::all_of(value, fits)) {
    refuse(point.key, each.whole ? "whole numbers " + bounds_text(each) : range_text(each) + " on every axis",
           as_given(point, value));
  }
  return value;
}

Value accept(const ChoiceParameter& choice, const std::string& word) {
  if (std::ranges::find(choice.choices, word) != choice.choices.end()) return word;
  const std::vector<std::string> known(choice.choices.begin(), choice.choices.end());
  throw ValueError(choice.key,
                   "unknown " + std::string(choice.key) + " '" + word + "'" + text::suggestion(word, known));
}

Value accept(const FlagParameter&, bool value) { return value; }

Value accept(const TextParameter& parameter, const std::string& text) {
  const std::string harmless = text::printable(text);
  if (parameter.form == TextParameter::Form::name &&
      (text.empty() || text.size() > kNameBytesMax || harmless != text)) {
    throw ValueError(parameter.key,
                     std::string(parameter.key) + " must have " + words(parameter) + ", got '" + harmless + "'");
  }
  return text;
}

Value accept(const RowsParameter& parameter, const Rows& rows) {
  const std::size_t columns = parameter.columns != 0 || rows.empty() ? parameter.columns : rows.front().size();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string row = "row " + std::to_string(i + 1) + " of " + std::string(parameter.key);
    if (rows[i].size() != columns) {
      throw ValueError(parameter.key,
                       row + " must have " + std::to_string(columns) + " numbers" +
                           (parameter.columns == 0 ? " like the first" : "") + ", got " +
                           std::to_string(rows[i].size()),
                       i);
    }
    if (!std::ranges::all_of(rows[i], [](double number) { return std::isfinite(number); })) {
      throw ValueError(parameter.key, row + " must have finite numbers only", i);
    }
  }
  return rows;
}

std::string written(const Value& value, Eigen::Index axes) {
  if (const auto* number = std::get_if<double>(&value)) return text::to_text(*number);
  if (const auto* point = std::get_if<Eigen::Vector3d>(&value)) return to_text(*point, axes);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return text::printable(std::get<std::string>(value));
}

}  // namespace

std::string_view key_of(const Parameter& parameter) noexcept {
  return std::visit([](const auto& any) { return any.key; }, parameter);
}

std::string_view meaning_of(const Parameter& parameter) noexcept {
  return std::visit([](const auto& any) { return any.meaning; }, parameter);
}

bool may_be_left_out(const Parameter& parameter) noexcept { return !preset_text(parameter).empty(); }

std::string accepted_text(const Parameter& parameter) {
  return std::visit([](const auto& any) { return words(any); }, parameter);
}

std::string accepted_suffix(std::string_view accepted) {
  std::string plain(accepted);
  std::erase(plain, '`');
  return " (accepted: " + plain + ")";
}

std::string preset_text(const Parameter& parameter) {
  return std::visit([](const auto& any) { return words_of_preset(any); }, parameter);
}

const Value& Values::at(std::string_view key) const {
  const auto found = values_.find(key);
  if (found == values_.end()) throw std::out_of_range("'" + std::string(key) + "' is asked for, but was not declared");
  return found->second;
}

Value checked(const Parameter& parameter, Value value) {
  return std::visit(
      [&]<class Any>(const Any& any) {
        if constexpr (std::is_same_v<Any, OtherParameter>) {
          return std::move(value);
        } else {
          const auto* own = std::get_if<typename Any::Type>(&value);
          if (own == nullptr) refuse(any.key, words(any), "a value of another type");
          return accept(any, *own);
        }
      },
      parameter);
}

Values completed(std::span<const Parameter> parameters, const Values& given) {
  Values all;
  std::vector<std::string> known;
  for (const Parameter& parameter : parameters) {
    const std::string& key = known.emplace_back(key_of(parameter));
    if (const auto found = given.all().find(key); found != given.all().end()) {
      all.set(key, checked(parameter, found->second));
    } else if (const auto preset = std::visit([](const auto& any) { return preset_of(any); }, parameter)) {
      all.set(key, *preset);
    } else if (!may_be_left_out(parameter) && !std::holds_alternative<OtherParameter>(parameter)) {
      throw ValueError(key, "'" + key + "' is missing" + accepted_suffix(accepted_text(parameter)));
    }
  }
  for (const auto& [key, value] : given.all()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    throw ValueError(key, "unknown key '" + key + "'" + text::suggestion(key, known));
  }
  return all;
}

std::string to_text(std::span<const Parameter> parameters, const Values& given, Eigen::Index axes) {
  std::string text;
  for (const Parameter& parameter : parameters) {
    const auto found = given.all().find(key_of(parameter));
    const auto* const word = std::get_if<TextParameter>(&parameter);
    const bool is_long = std::holds_alternative<RowsParameter>(parameter) ||
                         (word != nullptr && word->form != TextParameter::Form::file);
    if (found == given.all().end() || is_long) continue;
    text += (text.empty() ? "" : ", ") + found->first + " " + written(found->second, axes);
  }
  return text;
}

std::string to_text(const Eigen::Vector3d& point, Eigen::Index axes) {
  std::string text;
  for (const double value : point.head(axes)) text += (text.empty() ? "" : ", ") + text::to_text(value);
  return "[" + text + "]";
}

}  // namespace forcebound::config
