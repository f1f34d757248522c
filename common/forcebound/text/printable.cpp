#include "forcebound/text/printable.hpp"

#include <algorithm>

namespace forcebound::text {
namespace {

bool ascii_control(unsigned char c) noexcept { return c < 0x20 || c == 0x7f; }

// U+0080 to U+009F, among them a second way to begin an escape sequence.
bool begins_more_controls(unsigned char c) noexcept { return c == 0xc2; }
bool ends_more_controls(unsigned char c) noexcept { return c >= 0x80 && c < 0xa0; }

/// The bytes of a character that begins so; 1 for one that begins none.
std::size_t bytes_of_character(unsigned char c) noexcept {
  if (c >= 0xc2 && c < 0xe0) return 2;
  if (c >= 0xe0 && c < 0xf0) return 3;
  return c >= 0xf0 && c < 0xf5 ? 4 : 1;
}

bool continues_character(unsigned char c) noexcept { return (c & 0xc0U) == 0x80; }

}  // namespace

void make_printable(std::span<char> text) noexcept {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  for (std::size_t i = 0; i < text.size();) {
    if (begins_more_controls(byte(i)) && i + 1 < text.size() && ends_more_controls(byte(i + 1))) {
      text[i] = text[i + 1] = '?';
      i += 2;
      continue;
    }
    // A byte of this range that continues no character is a control character of its own in other encodings.
    if (ascii_control(byte(i)) || ends_more_controls(byte(i))) text[i] = '?';
    const std::size_t end = i + bytes_of_character(byte(i));
    ++i;
    while (i < end && i < text.size() && continues_character(byte(i))) ++i;
  }
}

std::string printable(std::string_view text) {
  std::string result(text);
  make_printable(result);
  return result;
}

std::string printable_lines(std::string_view text) {
  std::string result(text);
  const std::span<char> all(result);
  for (std::size_t begin = 0; begin <= result.size();) {
    const std::size_t end = std::min(result.find('\n', begin), result.size());
    make_printable(all.subspan(begin, end - begin));
    begin = end + 1;
  }
  return result;
}

}  // namespace forcebound::text
