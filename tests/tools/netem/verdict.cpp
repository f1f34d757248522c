#include "tests/tools/netem/verdict.hpp"

namespace forcebound::netem {
namespace {

std::string_view to_string(Fate fate) noexcept {
  switch (fate) {
    case Fate::forwarded:
      return "forwarded";
    case Fate::lost:
      return "lost";
    case Fate::over_limit:
      return "over-limit";
    case Fate::blackout:
      return "blackout";
  }
  return "unknown";
}

}  // namespace

std::string verdict_text(const Verdict& verdict) {
  std::string text;
  if (verdict.copy) text += "duplicate+";
  if (verdict.corrupted) text += "corrupted+";
  if (verdict.reordered) text += "reordered+";
  text += to_string(verdict.fate);
  return text;
}

}  // namespace forcebound::netem
