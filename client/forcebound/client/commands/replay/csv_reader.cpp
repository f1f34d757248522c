#include "forcebound/client/commands/replay/csv_reader.hpp"

#include <charconv>
#include <stdexcept>
#include <system_error>

namespace forcebound::client::commands {
namespace {

/// Text for a message, without control characters.
std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, kLongest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace

double parse_number(std::string_view text) {
  std::string_view digits = text::trimmed(text);
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) throw std::invalid_argument(in_quotes(text) + " is beyond a double");
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    throw std::invalid_argument(in_quotes(text) + " is not a number");
  }
  return value;
}

std::vector<std::string> CsvReader::header() {
  if (!lines_.next()) refuse("the file is empty, a line of column names was expected");
  const std::vector<std::string_view> fields = text::split(lines_.line(), ',');
  return {fields.begin(), fields.end()};
}

std::vector<double> CsvReader::row(const std::vector<std::string>& columns) {
  bool blank = false;
  while (lines_.next()) {
    if (lines_.line().empty()) {
      blank = true;
      continue;
    }
    if (blank) refuse("a row after a blank line; blank lines are accepted at the end only");
    const std::vector<std::string_view> fields = text::split(lines_.line(), ',');
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

}  // namespace forcebound::client::commands
