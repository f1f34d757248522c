#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace forcebound::config {

/// A value of a TOML file, and the line where it begins. Only the parser includes the TOML library.
struct Node {
  using List = std::vector<Node>;
  using Table = std::map<std::string, Node, std::less<>>;
  struct Time {
    std::string text;
  };

  std::variant<Table, List, std::string, double, std::int64_t, bool, Time> value{};
  int line = 1;

  /// Null if it is of another type.
  template <class Type>
  [[nodiscard]] const Type* as() const noexcept {
    return std::get_if<Type>(&value);
  }
  template <class Type>
  [[nodiscard]] Type* as() noexcept {
    return std::get_if<Type>(&value);
  }

  /// The value of a key; null if there is none, or if this is no table.
  [[nodiscard]] const Node* find(std::string_view key) const noexcept;

  /// The text at a key; empty if there is none.
  [[nodiscard]] std::string text_at(std::string_view key) const;
};

/// The value in TOML syntax: "0.5", "'ball'", "[0, 0, 1]".
[[nodiscard]] std::string written(const Node& node);

/// Limits on what is given to the TOML library, which calls itself for each part of a key and for each level of lists
/// and tables.
inline constexpr std::size_t kTomlBytesMost = std::size_t{16} << 20U;
inline constexpr std::size_t kTomlLevelsMost = 32;
inline constexpr std::size_t kTomlKeyPartsMost = 8;

/// @param place the file's name, for errors
/// @return the file's top-level table
/// @throws ConfigError `PLACE:LINE: not TOML: ...`, and for what is beyond the limits above
[[nodiscard]] Node parse_toml(std::string_view text, const std::string& place);

/// Parses one value in TOML syntax, as after `KEY = `. @throws ConfigError unless the text is exactly one value
[[nodiscard]] Node parse_toml_value(std::string_view text, int line);

}  // namespace forcebound::config
