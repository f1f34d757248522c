#include "forcebound/text/printable.hpp"

namespace forcebound::text {
namespace {

bool ascii_control(unsigned char c) noexcept { return c < 0x20 || c == 0x7f; }

// U+0080 to U+009F, among them a second way to begin an escape sequence.
bool begins_more_controls(unsigned char c) noexcept { return c == 0xc2; }
bool ends_more_controls(unsigned char c) noexcept { return c >= 0x80 && c < 0xa0; }

}  // namespace

void make_printable(std::span<char> text) noexcept {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
    if (ascii_control(byte(i))) {
      text[i] = '?';
    } else if (begins_more_controls(byte(i)) && i + 1 < text.size() && ends_more_controls(byte(i + 1))) {
      text[i] = text[i + 1] = '?';
    }
  }
}

std::string printable(std::string_view text) {
  std::string result(text);
  make_printable(result);
  return result;
}

}  // namespace forcebound::text
