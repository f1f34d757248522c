#include "forcebound/server/security/secure_counters.hpp"

#include <array>

#include "forcebound/server/session/count_text.hpp"

namespace forcebound::server {
namespace {

/// Of sealed datagrams, by security::Opening.
constexpr std::array kOpenings{
    "opened",          "malformed",           "too long",     "of another session", "of unknown keys",
    "of expired keys", "replayed or too old", "not authentic"};

}  // namespace

void SecureCounters::add(const SecureCounters& other) noexcept {
#define FORCEBOUND_ADD(subject, name, words) name += other.name;
  FORCEBOUND_SECURE_COUNTS(FORCEBOUND_ADD)
#undef FORCEBOUND_ADD
  records += other.records;
}

std::string SecureCounters::text() const {
  CountText counts;
  for (std::size_t i = 0; i < records.size(); ++i) counts.add("sealed datagrams", records.at(i), kOpenings[i]);
#define FORCEBOUND_ADD(subject, name, words) counts.add(subject, name, words);
  FORCEBOUND_SECURE_COUNTS(FORCEBOUND_ADD)
#undef FORCEBOUND_ADD
  return counts.text();
}

}  // namespace forcebound::server
