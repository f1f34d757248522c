#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace forcebound::text {

/// Without the blanks, tabs and carriage returns around it.
[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;

/// The fields of a line, each without the blanks around it. They point into `text`, which must outlive them.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

/// The words of a text, between blanks of any kind and line ends. They point into `text`, which must outlive them.
[[nodiscard]] std::vector<std::string_view> split_at_blanks(std::string_view text);

/// Reads a text line by line, with Unix or Windows line ends, with or without a byte order mark; errors say which line
/// they are about.
class LineReader {
 public:
  /// @param name of the file, for messages.
  LineReader(std::istream& text, std::string name) : text_(text), name_(std::move(name)) {}

  /// Goes to the next line, if there is one. @throws std::runtime_error if the text cannot be read.
  [[nodiscard]] bool next();

  /// The line that `next` went to, without the blanks around it.
  [[nodiscard]] std::string_view line() const noexcept { return trimmed(line_); }

  /// @throws std::runtime_error "file:line: what", the line being the one that `next` went to last.
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  std::istream& text_;
  std::string name_;
  std::string line_;
  std::size_t number_ = 0;
};

}  // namespace forcebound::text
