#include "tests/tools/relay/control.hpp"

#include <stdexcept>
#include <vector>

#include "forcebound/text/lines.hpp"
#include "forcebound/text/printable.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/netem_values.hpp"

namespace forcebound::relay {
namespace {

std::string in_words(const std::string& netem) { return netem.empty() ? "perfect" : netem; }

}  // namespace

Control::Answer Control::answer(std::string_view line, Nanoseconds now) {
  const std::vector<std::string_view> parts = text::split_at_blanks(line);
  const std::string_view way = parts.empty() ? std::string_view{} : parts.front();
  std::string words;
  for (std::size_t i = 1; i < parts.size(); ++i) words.append(i > 1 ? " " : "").append(parts[i]);
  if (way == "status" && words.empty()) return {.text = status()};
  const bool up = way == "up" || way == "both";
  const bool down = way == "down" || way == "both";
  if (!up && !down) {
    return {.text = "error: expected up, down or both and the words of 'tc ... netem', or status, got '" +
                    text::printable(std::string(way) + (words.empty() ? "" : " " + words)) + "'"};
  }
  try {
    const netem::NetemParameters netem = netem::parse_netem(words);
    words = netem::with_units(words);
    if (up) relay_.change(Direction::up, netem, now);
    if (down) relay_.change(Direction::down, netem, now);
  } catch (const std::invalid_argument& error) {
    return {.text = "error: " + text::printable(error.what())};
  }
  if (up) words_.up = words;
  if (down) words_.down = words;
  return {.text = status(), .changed = true};
}

std::string Control::status() const { return "up: " + in_words(words_.up) + "; down: " + in_words(words_.down); }

}  // namespace forcebound::relay
