#include "forcebound/server/session/counters.hpp"

#include "forcebound/server/session/count_text.hpp"

namespace forcebound::server {

void ServerCounters::add(const ServerCounters& other) noexcept {
#define FORCEBOUND_ADD(subject, name, words) name += other.name;
  FORCEBOUND_SERVER_COUNTS(FORCEBOUND_ADD)
#undef FORCEBOUND_ADD
  malformed += other.malformed;
}

void ServerCounters::add(const EnvironmentFaults& faults) noexcept {
  old_normals += faults.old_normals;
  objects_quarantined += faults.quarantined;
  contacts_left_out += faults.contacts_left_out;
  not_converged += faults.not_converged;
  slipped_us += static_cast<std::uint64_t>(faults.slipped_s * 1e6);
}

std::string ServerCounters::text() const {
  CountText counts;
#define FORCEBOUND_ADD(subject, name, words) counts.add(subject, name, words);
  FORCEBOUND_SERVER_COUNTS(FORCEBOUND_ADD)
#undef FORCEBOUND_ADD
  for (const wire::MalformedRow& row : wire::kMalformed) counts.add("datagrams", malformed[row.reason], row.word);
  return counts.text();
}

}  // namespace forcebound::server
