#include "forcebound/server/session/counters.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace forcebound::server {
namespace {

TEST(ServerCounters, TextLeavesOutZeroCounts) {
  EXPECT_EQ(ServerCounters{}.text(),
            "sessions: 0 opened\n"
            "motions: 0 received\n"
            "forces: 0 sent\n"
            "pieces of scenes: 0 sent\n"
            "datagrams: 0 received\n");
}

TEST(ServerCounters, NameEveryReason) {
  ServerCounters counters;
  counters.datagrams = 9;
  counters.malformed = {{{1, 2, 3, 4, 5, 6}}};
  counters.motions_received = 7;
  counters.motions_reordered = 2;
  EXPECT_EQ(counters.text(),
            "sessions: 0 opened\n"
            "motions: 7 received, 2 reordered\n"
            "forces: 0 sent\n"
            "pieces of scenes: 0 sent\n"
            "datagrams: 9 received, 1 oversize, 2 truncated, 3 foreign, 4 corrupt, 5 unreadable, 6 not finite\n");
}

TEST(ServerCounters, AddEachCountToItsOwn) {
  ServerCounters first;
  ServerCounters second;
  std::uint64_t number = 0;
  const auto fill = [&number](std::uint64_t& one, std::uint64_t& other) {
    one = ++number;
    other = 1000 * number;
  };
#define FORCEBOUND_FILL(subject, name, words) fill(first.name, second.name);
  FORCEBOUND_SERVER_COUNTS(FORCEBOUND_FILL)
#undef FORCEBOUND_FILL
  for (std::size_t i = 0; i < first.malformed.size(); ++i) {
    const auto kind = static_cast<wire::Malformed>(i);
    fill(first.malformed[kind], second.malformed[kind]);
  }
  first.add(second);
  number = 0;
#define FORCEBOUND_CHECK(subject, name, words) EXPECT_EQ(first.name, 1001 * ++number) << words;
  FORCEBOUND_SERVER_COUNTS(FORCEBOUND_CHECK)
#undef FORCEBOUND_CHECK
  for (const std::uint64_t count : first.malformed) EXPECT_EQ(count, 1001 * ++number);
}

TEST(ServerCounters, AddTheFaultsOfEachSession) {
  ServerCounters counters;
  const EnvironmentFaults faults{
      .old_normals = 1, .quarantined = 2, .contacts_left_out = 3, .not_converged = 4, .slipped_s = 5e-6};
  counters.add(faults);
  counters.add(faults);
  EXPECT_EQ(counters.old_normals, 2U);
  EXPECT_EQ(counters.objects_quarantined, 4U);
  EXPECT_EQ(counters.contacts_left_out, 6U);
  EXPECT_EQ(counters.not_converged, 8U);
  EXPECT_EQ(counters.slipped_us, 10U);
}

}  // namespace
}  // namespace forcebound::server
