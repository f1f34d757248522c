#include "tests/lab/csv_reader.hpp"

#include <charconv>
#include <istream>
#include <stdexcept>
#include <system_error>

namespace forcebound::lab {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// For a message: what cannot be shown is not.
std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, kLongest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace

double parse_number(std::string_view text) {
  std::string_view digits = trimmed(text);
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) throw std::invalid_argument(quoted(text) + " is beyond a double");
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    throw std::invalid_argument(quoted(text) + " is not a number");
  }
  return value;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> fields;
  for (;;) {
    const auto end = text.find(separator);
    fields.emplace_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string> CsvReader::header() {
  if (!next_line()) refuse("the file is empty, a line of column names was expected");
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (line_.starts_with(kByteOrderMark)) line_.erase(0, kByteOrderMark.size());
  return split(line_, ',');
}

std::vector<double> CsvReader::row(const std::vector<std::string>& columns) {
  bool blank = false;
  while (next_line()) {
    if (trimmed(line_).empty()) {
      blank = true;
      continue;
    }
    if (blank) refuse("a row after a blank line; blank lines are accepted at the end only");
    const std::vector<std::string> fields = split(line_, ',');
    if (fields.size() != columns.size()) {
      refuse("expected " + std::to_string(columns.size()) + " numbers, got " + std::to_string(fields.size()));
    }
    std::vector<double> numbers;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      try {
        numbers.push_back(parse_number(fields[i]));
      } catch (const std::invalid_argument& error) {
        refuse(columns[i] + ": " + error.what() + "; a number such as 0.25 or -1e-3, nan or inf was expected");
      }
    }
    return numbers;
  }
  return {};
}

void CsvReader::refuse(const std::string& what) const {
  throw std::runtime_error(name_ + ":" + std::to_string(line_number_) + ": " + what);
}

bool CsvReader::next_line() {
  ++line_number_;
  if (std::getline(input_, line_)) return true;
  if (input_.bad()) refuse("cannot be read");
  return false;
}

}  // namespace forcebound::lab
