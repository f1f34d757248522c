#include "forcebound/text/terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace forcebound::text {
namespace {

/// How much of a line fits: up to the last blank that fits, or else after the last comma of a word that is too long
/// alone. All of it if it cannot be broken.
std::size_t part_that_fits(std::string_view line, std::size_t from, std::size_t columns) {
  std::size_t blank = std::string_view::npos;
  std::size_t comma = std::string_view::npos;
  std::size_t used = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    used += (static_cast<unsigned char>(line[i]) & 0xc0U) != 0x80U;
    if (i > from && line[i] == ' ' && used <= columns + 1) blank = i;
    if (i > from && line[i] == ',' && used <= columns) comma = i + 1;
    if (used <= columns) continue;
    if (blank != std::string_view::npos) return blank;
    if (comma != std::string_view::npos) return comma;
    if (line[i] == ' ' && i > from) return i;
  }
  return line.size();
}

void append_wrapped(std::string& out, std::string_view line, std::size_t indent, std::size_t columns) {
  std::string rest(line);
  while (columns_of(rest) > columns) {
    // From the column where the words begin: the blanks between a name and its words are no place to break.
    const std::size_t first = rest.find_first_not_of(' ');
    const std::size_t end = part_that_fits(rest, std::max(indent, first == std::string::npos ? 0 : first), columns);
    if (end >= rest.size()) break;
    out.append(rest, 0, end).append("\n");
    const std::size_t next = rest.find_first_not_of(' ', end);
    if (next == std::string::npos) return;
    rest = std::string(indent, ' ') + rest.substr(next);
  }
  out += rest;
  out += '\n';
}

/// The column where a line continues: that of its description, after a name and two blanks or more; without one, `more`
/// to the right of its start.
std::size_t hanging_indent(std::string_view line, std::size_t more) {
  constexpr std::size_t kLatest = 40;
  const std::size_t name = line.find_first_not_of(' ');
  if (name == std::string_view::npos) return 0;
  const std::size_t gap = line.find("  ", name);
  if (gap == std::string_view::npos) return name + more;
  const std::size_t description = line.find_first_not_of(' ', gap);
  return description == std::string_view::npos || description > kLatest ? name + more : description;
}

template <typename Indent>
std::string each_wrapped(std::string_view text, std::size_t columns, Indent indent) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    append_wrapped(out, line, indent(line), columns);
    if (end == std::string_view::npos) {
      out.pop_back();  // the text did not end its last line
      break;
    }
    text.remove_prefix(end + 1);
  }
  return out;
}

}  // namespace

Colour colour_for(int descriptor) noexcept {
  const char* const unwanted = std::getenv("NO_COLOR");
  if (unwanted != nullptr && *unwanted != '\0') return Colour::none;
  const char* const terminal = std::getenv("TERM");
  if (terminal == nullptr || std::string_view(terminal) == "dumb") return Colour::none;
  return isatty(descriptor) != 0 ? Colour::ansi : Colour::none;
}

std::string red(std::string_view text, Colour colour) {
  if (colour == Colour::none) return std::string(text);
  return "\033[31m" + std::string(text) + "\033[0m";
}

std::size_t columns_of(std::string_view text) noexcept {
  std::size_t columns = 0;
  for (const char c : text) columns += (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
  return columns;
}

std::string wrapped(std::string_view text, std::size_t indent, std::size_t columns) {
  return each_wrapped(text, columns, [indent](std::string_view) { return indent; });
}

std::string wrapped_help(std::string_view help, std::size_t columns) {
  return wrapped_below_descriptions(help, 0, columns);
}

std::string wrapped_below_descriptions(std::string_view text, std::size_t more, std::size_t columns) {
  return each_wrapped(text, columns, [more](std::string_view line) { return hanging_indent(line, more); });
}

std::string counted(std::uint64_t count, std::string_view one, std::string_view many) {
  std::string text = std::to_string(count) + " ";
  if (count == 1) return text.append(one);
  return many.empty() ? text.append(one).append("s") : text.append(many);
}

}  // namespace forcebound::text
