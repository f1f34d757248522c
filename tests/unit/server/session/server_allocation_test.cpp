#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

class ServerAllocation : public ServerFixture {};

TEST_F(ServerAllocation, MotionDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto session = join();
  link.keep = false;
  const test::AllocationGuard guard;
  for (std::uint64_t i = 1; i <= 100; ++i) {
    arrive(motion(session, 4 * i, 0.001));      // answered
    arrive(motion(session, 4 * i, 0.001));      // duplicate
    arrive(motion(session, 4 * i - 1, 0.001));  // late
    arrive(motion(session + 1, i));             // refused
    arrive(motion(session, 4 * i + 1, 1e308));  // answered, with no finite force
  }
  EXPECT_EQ(guard.heap_operations(), 0u);
  EXPECT_EQ(server->counters().forces_sent, 200u);
  EXPECT_EQ(server->counters().motions_duplicated, 100u);
  EXPECT_EQ(server->counters().motions_reordered, 100u);
  EXPECT_EQ(server->counters().motions_without_session, 100u);
}

TEST_F(ServerAllocation, OpeningASessionAllocatesSoThatTheHookIsKnownToWork) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  link.keep = false;
  const test::AllocationGuard guard;
  arrive(hello());
  EXPECT_GT(guard.heap_operations(), 0u);
}

}  // namespace
}  // namespace forcebound::server
