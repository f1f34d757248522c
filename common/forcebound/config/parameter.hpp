#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace forcebound::config {

using Rows = std::vector<std::vector<double>>;
using Value = std::variant<double, Eigen::Vector3d, std::string, bool, Rows>;

// Declarations of keys that a table of a file may have: name with unit, meaning, accepted values, and preset. Readers,
// their errors and the schema page all use these declarations.
//
// A key without a preset is required, unless `absent` describes the effect of leaving it out. Texts must outlive the
// declaration, as literals do.

/// A finite number.
struct NumberParameter {
  using Type = double;

  std::string_view key{};
  std::string_view meaning{};
  /// Used where the file has no such key. A preset out of range means "not given".
  std::optional<double> preset{};
  double least = -std::numeric_limits<double>::infinity();
  bool least_excluded = false;
  double most = std::numeric_limits<double>::infinity();
  bool whole = false;
  std::string_view absent{};
};

/// A number > 0 and <= `most`; without a preset it must be given.
[[nodiscard]] inline NumberParameter positive_number(std::string_view key, std::string_view meaning,
                                                     double most = std::numeric_limits<double>::infinity(),
                                                     std::optional<double> preset = {}) {
  return {.key = key, .meaning = meaning, .preset = preset, .least = 0, .least_excluded = true, .most = most};
}

/// A position, velocity, force or size; or a direction of nonzero length. One number per axis of the scene.
struct PointParameter {
  using Type = Eigen::Vector3d;

  std::string_view key;
  std::string_view meaning{};
  std::optional<Eigen::Vector3d> preset{};
  bool is_direction = false;    ///< it is normalised
  NumberParameter each{};       ///< range of each number
  double rest = 0;              ///< value on axes that the scene lacks
  std::string_view accepted{};  ///< in words; empty: derived from the fields above
};

/// One of several words; the first is the preset, unless `absent` says otherwise.
struct ChoiceParameter {
  using Type = std::string;

  std::string_view key;
  std::string_view meaning{};
  std::vector<std::string_view> choices{};
  std::string_view absent{};
};

/// `true` or `false`.
struct FlagParameter {
  using Type = bool;

  std::string_view key;
  std::string_view meaning{};
  bool preset = false;
};

/// A text.
struct TextParameter {
  using Type = std::string;

  enum class Form {
    any,
    name,  ///< fit for a log line: 1 to 64 bytes without control characters
    file,  ///< path, relative to this file's folder or absolute
  };

  std::string_view key;
  std::string_view meaning{};
  Form form = Form::any;
  std::string_view accepted{};  ///< in words; empty: derived from the form
  std::string_view absent{};
};

/// A list of rows of numbers, all of one length.
struct RowsParameter {
  using Type = Rows;

  std::string_view key;
  std::string_view meaning{};
  std::string_view accepted = "a list of rows of numbers";
  std::size_t columns = 0;  ///< of each row; 0: as in the first row
  std::string_view absent{};
};

/// A key whose value the reader parses itself, such as a table.
struct OtherParameter {
  std::string_view key;
  std::string_view meaning{};
  std::string_view accepted = "a table";
  std::string_view absent{};
};

using Parameter = std::variant<NumberParameter, PointParameter, ChoiceParameter, FlagParameter, TextParameter,
                               RowsParameter, OtherParameter>;

/// A table of a file: its purpose, and every key it may have.
struct TableDescription {
  std::string title;
  std::string text;
  std::vector<Parameter> keys;
};

[[nodiscard]] std::string_view key_of(const Parameter& parameter) noexcept;
[[nodiscard]] std::string_view meaning_of(const Parameter& parameter) noexcept;

/// Whether the key is optional.
[[nodiscard]] bool may_be_left_out(const Parameter& parameter) noexcept;

/// "> 0 and <= 100", "a whole number from 1 to 16", "a direction", "`true` or `false`": what is accepted, as Markdown.
[[nodiscard]] std::string accepted_text(const Parameter& parameter);

/// " (accepted: > 0 and <= 100)": the end of an error about a missing key.
/// @param accepted as Markdown, of which a terminal is not shown the backticks
[[nodiscard]] std::string accepted_suffix(std::string_view accepted);

/// Its preset, as Markdown; empty: the key is required.
[[nodiscard]] std::string preset_text(const Parameter& parameter);

/// Values by key.
class Values {
 public:
  Values() = default;
  Values(std::initializer_list<std::pair<const std::string, Value>> values) : values_(values) {}

  void set(std::string_view key, Value value) { values_.insert_or_assign(std::string(key), std::move(value)); }
  [[nodiscard]] bool has(std::string_view key) const noexcept { return values_.contains(key); }

  /// @throws std::out_of_range, std::bad_variant_access if no such key was declared: a bug in the
  /// code that reads it.
  [[nodiscard]] double number(std::string_view key) const { return std::get<double>(at(key)); }
  [[nodiscard]] int whole(std::string_view key) const { return static_cast<int>(number(key)); }
  [[nodiscard]] Eigen::Vector3d point(std::string_view key) const { return std::get<Eigen::Vector3d>(at(key)); }
  [[nodiscard]] const std::string& choice(std::string_view key) const { return text(key); }
  [[nodiscard]] const std::string& text(std::string_view key) const { return std::get<std::string>(at(key)); }
  [[nodiscard]] bool flag(std::string_view key) const { return std::get<bool>(at(key)); }
  [[nodiscard]] const Rows& rows(std::string_view key) const { return std::get<Rows>(at(key)); }

  /// All of them, by key.
  [[nodiscard]] const std::map<std::string, Value, std::less<>>& all() const noexcept { return values_; }

  friend bool operator==(const Values&, const Values&) = default;

 private:
  [[nodiscard]] const Value& at(std::string_view key) const;

  std::map<std::string, Value, std::less<>> values_;
};

/// A refused value: `what()` names the key, the accepted values and the value given.
class ValueError : public std::invalid_argument {
 public:
  ValueError(std::string_view key, const std::string& what, std::optional<std::size_t> row = {})
      : std::invalid_argument(what), key_(key), row_(row) {}

  /// The key, so that a reader can find its line.
  [[nodiscard]] const std::string& key() const noexcept { return key_; }
  [[nodiscard]] std::optional<std::size_t> row() const noexcept { return row_; }  ///< of a list of rows

 private:
  std::string key_;
  std::optional<std::size_t> row_;
};

/// The value, normalised if it is a direction. @throws ValueError unless it is accepted
[[nodiscard]] Value checked(const Parameter& parameter, Value value);

/// The given values, checked, with presets for absent keys. They may come from a file, a message or code. An
/// OtherParameter is not among them.
/// @throws ValueError for an unknown key, a missing required key or a refused value
[[nodiscard]] Values completed(std::span<const Parameter> parameters, const Values& given);

/// "radius_m 0.02, center_m [0, 0]": the given values in the order of the declarations, without lists of rows and
/// texts.
/// @param axes how many numbers a point has
[[nodiscard]] std::string to_text(std::span<const Parameter> parameters, const Values& given, Eigen::Index axes = 3);

/// "[0, 0, 0.5]".
[[nodiscard]] std::string to_text(const Eigen::Vector3d& point, Eigen::Index axes = 3);

}  // namespace forcebound::config
