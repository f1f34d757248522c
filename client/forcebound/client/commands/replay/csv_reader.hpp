#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/text/lines.hpp"

namespace forcebound::client::commands {

/// Reads a table of numbers under a line of names, row by row.
///
/// Unix and Windows line ends, blanks around a field, a byte order mark and blank lines at the end are accepted; `nan`
/// and `inf` are numbers.
class CsvReader {
 public:
  /// @param name of the file, for messages.
  CsvReader(std::istream& input, std::string name) : lines_(input, std::move(name)) {}

  /// The fields of the first line. @throws std::runtime_error if there is none.
  [[nodiscard]] std::vector<std::string> header();

  /// The next row, or nothing at the end. @throws std::runtime_error unless it has `columns` numbers.
  [[nodiscard]] std::vector<double> row(const std::vector<std::string>& columns);

  /// @throws std::runtime_error "file:line: what", the line being the one read last.
  [[noreturn]] void refuse(const std::string& what) const { lines_.refuse(what); }

 private:
  text::LineReader lines_;
};

/// A whole field as a number, in any notation with a decimal point, whatever the locale.
/// @throws std::invalid_argument "'...' is not a number" or "... is beyond a double".
[[nodiscard]] double parse_number(std::string_view text);

}  // namespace forcebound::client::commands
