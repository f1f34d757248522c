#include "forcebound/record/blackout.hpp"

#include "forcebound/text/numbers.hpp"

namespace forcebound::record {
namespace {

std::string share(std::uint64_t lost, std::uint64_t all, const char* words) {
  return std::to_string(all - lost) + " of " + std::to_string(all) + " " + words;
}

std::string counts_in_words(const Blackout& blackout) {
  std::string text = blackout.motions == 0 ? "no motion was sent in it"
                                           : share(blackout.lost_up, blackout.motions, "motions arrived there ") +
                                                 (up_died(blackout) ? "(up dead)" : "(up alive)");
  text += blackout.answers == 0 ? ", so no answer was due"
                                : ", " + share(blackout.lost_down, blackout.answers, "answers came back ") +
                                      (down_died(blackout) ? "(down dead)" : "(down alive)");
  if (blackout.server_left) text += ", and the server ended the session";
  return text;
}

}  // namespace

bool up_died(const Blackout& blackout) noexcept {
  return blackout.counted && blackout.lost_up > blackout.motions - blackout.lost_up;
}

bool down_died(const Blackout& blackout) noexcept {
  return blackout.counted && blackout.lost_down > blackout.answers - blackout.lost_down;
}

std::string_view what_died(const Blackout& blackout) noexcept {
  if (!blackout.counted) return blackout.server_left ? "server" : "unknown";
  if (up_died(blackout)) return down_died(blackout) ? "both" : "up";
  return down_died(blackout) ? "down" : "neither";
}

std::string words_of(const Blackout& blackout, const std::string& server) {
  std::string text =
      "nothing came back from " + server + " for " + text::fixed(time::to_seconds(blackout.duration), 2) + " s";
  text += blackout.over ? ": " : " until the end: ";
  if (blackout.counted) return text + counts_in_words(blackout);
  if (blackout.server_left) return text + "the server had ended the session";
  if (blackout.over) return text + "then in another session: the server had restarted or closed this one";
  return text + "it is not known which direction lost the datagrams";
}

}  // namespace forcebound::record
