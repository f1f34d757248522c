#include "forcebound/record/silence.hpp"

#include <cstdio>

namespace forcebound::record {
namespace {

std::string share(std::uint64_t lost, std::uint64_t all, const char* words) {
  return std::to_string(all - lost) + " of " + std::to_string(all) + " " + words;
}

std::string counts_in_words(const Silence& silence) {
  std::string text = silence.motions == 0 ? "no motion was sent in it"
                                          : share(silence.lost_up, silence.motions, "motions arrived there ") +
                                                (up_died(silence) ? "(up dead)" : "(up alive)");
  text += silence.answers == 0 ? ", so no answer was due"
                               : ", " + share(silence.lost_down, silence.answers, "answers came back ") +
                                     (down_died(silence) ? "(down dead)" : "(down alive)");
  if (silence.server_left) text += ", and the server ended the session";
  return text;
}

}  // namespace

bool up_died(const Silence& silence) noexcept {
  return silence.counted && silence.lost_up > silence.motions - silence.lost_up;
}

bool down_died(const Silence& silence) noexcept {
  return silence.counted && silence.lost_down > silence.answers - silence.lost_down;
}

std::string_view what_died(const Silence& silence) noexcept {
  if (!silence.counted) return silence.server_left ? "server" : "unknown";
  if (up_died(silence)) return down_died(silence) ? "both" : "up";
  return down_died(silence) ? "down" : "neither";
}

std::string words_of(const Silence& silence, const std::string& server) {
  char duration[32];
  std::snprintf(duration, sizeof duration, "%.2f s", time::to_seconds(silence.duration));
  std::string text = "nothing came back from " + server + " for " + duration;
  text += silence.over ? ": " : " until the end: ";
  if (silence.counted) return text + counts_in_words(silence);
  if (silence.server_left) return text + "the server had ended the session";
  if (silence.over) return text + "then in another session: the server had restarted or given this one up";
  return text + "which way died, and so which way lost what is missing, is not known";
}

}  // namespace forcebound::record
