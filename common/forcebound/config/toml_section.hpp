#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/vector.hpp"

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

namespace forcebound::config {

using control::Matrix;
using control::Vector;

/// What a number in a device file must be.
enum class Allowed { positive, not_negative, any };

/// @param place the file's name, for errors.
/// @throws std::runtime_error `PLACE:LINE: not TOML: ...`.
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& place);

/// A table of a device or law file, read key by key. Only for the loaders' .cpp files.
///
/// @throws std::runtime_error from every member: `FILE:LINE: SUBJECT: KEY must be ..., got ...`.
class TomlSection {
 public:
  /// @param place the file's name, and `subject` what it describes, for errors. `table` must outlive this.
  TomlSection(const toml::table& table, std::string place, std::string subject)
      : table_(table), place_(std::move(place)), subject_(std::move(subject)) {}

  [[nodiscard]] bool has(std::string_view key);
  [[nodiscard]] std::string text(std::string_view key);
  [[nodiscard]] int integer(std::string_view key, int least, int most);
  [[nodiscard]] double number(std::string_view key, Allowed allowed);
  [[nodiscard]] double number_or(std::string_view key, Allowed allowed, double otherwise);

  [[nodiscard]] bool flag_or(std::string_view key, bool otherwise);

  /// One number for all, or a list of `rows`.
  [[nodiscard]] Vector vector(std::string_view key, int rows, Allowed allowed);
  [[nodiscard]] Vector vector_or(std::string_view key, int rows, Allowed allowed, double otherwise);

  /// One number or a list for the diagonal, or a list of rows: symmetric and positive definite.
  [[nodiscard]] Matrix matrix(std::string_view key, int rows);

  [[nodiscard]] TomlSection section(std::string_view key);

  /// To be called when all has been read.
  void refuse_other_keys(const std::string& refusal = "unknown key") const;

  /// Refuses the value at `key`.
  [[noreturn]] void refuse(std::string_view key, const std::string& must_be) const;

 private:
  [[nodiscard]] const toml::node& required(std::string_view key);
  [[nodiscard]] double number_at(const toml::node& node, const std::string& what, Allowed allowed) const;
  [[nodiscard]] Vector vector_at(const toml::array& list, std::string_view key, int rows, Allowed allowed) const;
  [[noreturn]] void fail(const toml::node& node, const std::string& message) const;

  const toml::table& table_;
  std::string place_;
  std::string subject_;
  std::vector<std::string> known_;
};

}  // namespace forcebound::config
