#include "forcebound/server/app/fleet_member.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <vector>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

/// A member that is asked every 100 ms, and whose sidecar takes all calls.
class Member {
 public:
  explicit Member(const FleetMember::Options& options = {}) : member(options) {}

  FleetMember& operator*() { return member; }

  void sessions(std::size_t count) { member.set_sessions(count, now); }

  /// What of its life cycle is told within a time.
  std::vector<FleetCall> calls_within(time::Nanoseconds duration) {
    std::vector<FleetCall> told;
    for (const auto end = now + duration; now < end; now += 100ms) {
      for (;;) {
        const FleetCall call = member.next(now, turning);
        if (call == FleetCall::none) break;
        member.done(call, now);
        if (call == FleetCall::look) member.apply_state(seen, now);
        if (call == FleetCall::health) ++healthy;
        if (call == FleetCall::health || call == FleetCall::look || call == FleetCall::count) continue;
        told.push_back(call);
      }
    }
    return told;
  }

  FleetState seen{.allocated = false, .health_period = 5s};
  bool turning = true;
  int healthy = 0;
  time::Nanoseconds now{0};
  FleetMember member;
};

TEST(AFleetMember, IsReadyOnceAndInUseFromItsFirstSession) {
  Member member;
  EXPECT_THAT(member.calls_within(30s), ElementsAre(FleetCall::ready));
  member.sessions(1);
  member.seen.allocated = true;
  EXPECT_THAT(member.calls_within(1s), ElementsAre(FleetCall::allocate));
  member.sessions(3);
  EXPECT_THAT(member.calls_within(3600s), ElementsAre());
}

TEST(AFleetMember, IsReadyAgainOnlyWhenNobodyHasComeBack) {
  Member member;
  member.calls_within(1s);
  member.sessions(1);
  member.seen.allocated = true;
  member.calls_within(10s);
  member.sessions(0);
  EXPECT_THAT(member.calls_within(4s), ElementsAre());
  member.sessions(1);
  EXPECT_THAT(member.calls_within(60s), ElementsAre());
  member.sessions(0);
  EXPECT_THAT(member.calls_within(4900ms), ElementsAre());
  EXPECT_THAT(member.calls_within(200ms), ElementsAre(FleetCall::ready));
}

TEST(AFleetMember, ShutsDownAfterUseIfItIsTo) {
  Member member({.after_use = AfterUse::shut_down, .places = 7});
  member.calls_within(1s);
  member.sessions(1);
  member.seen.allocated = true;
  member.calls_within(10s);
  EXPECT_EQ((*member).count(), 1);
  member.sessions(0);
  EXPECT_EQ((*member).count(), 7) << "nobody is to be sent there any more";
  EXPECT_THAT(member.calls_within(10s), ElementsAre(FleetCall::shut_down));
  EXPECT_TRUE((*member).shut_down());
  EXPECT_THAT(member.calls_within(60s), ElementsAre());
}

TEST(AFleetMember, ThatIsAllocatedWaitsForItsClientAMinuteAndIsThenReadyAgain) {
  for (const AfterUse after_use : {AfterUse::ready, AfterUse::shut_down}) {
    Member member({.after_use = after_use});
    member.calls_within(10s);
    member.seen.allocated = true;
    EXPECT_THAT(member.calls_within(59s), ElementsAre());
    EXPECT_TRUE((*member).allocated());
    EXPECT_THAT(member.calls_within(5s), ElementsAre(FleetCall::ready));
  }
}

TEST(AFleetMember, IsNotAllocatedAnewByWhatTheSidecarStillShows) {
  Member member;
  member.calls_within(1s);
  member.sessions(1);
  EXPECT_THAT(member.calls_within(1900ms), ElementsAre(FleetCall::allocate)) << "the sidecar shows Ready for a while";
  member.seen.allocated = true;
  EXPECT_THAT(member.calls_within(10s), ElementsAre());
}

TEST(AFleetMember, ThatSomebodyElseMadeReadyWhileInUseIsAllocatedAgain) {
  Member member;
  member.calls_within(1s);
  member.sessions(1);
  member.seen.allocated = true;
  member.calls_within(10s);
  member.seen.allocated = false;
  EXPECT_THAT(member.calls_within(2s), ElementsAre(FleetCall::allocate));
}

TEST(AFleetMember, IsHealthyTwiceInAPeriodAndOnlyWhileItTurns) {
  Member member;
  member.calls_within(10s);
  EXPECT_GE(member.healthy, 4);
  EXPECT_LE(member.healthy, 6);
  member.turning = false;
  member.healthy = 0;
  member.calls_within(60s);
  EXPECT_EQ(member.healthy, 0);
}

TEST(AFleetMember, AsksASilentSidecarMoreAndMoreSeldom) {
  FleetMember member({});
  std::vector<time::Nanoseconds> asked;
  for (time::Nanoseconds now{0}; now < 20s; now += 100ms) {
    if (member.next(now, true) == FleetCall::none) continue;
    EXPECT_EQ(member.next(now, true), FleetCall::ready);
    asked.push_back(now);
    member.failed(now);
  }
  EXPECT_THAT(asked, ElementsAre(0s, 500ms, 1500ms, 3500ms, 7500ms, 12500ms, 17500ms));
}

TEST(AFleetMember, TellsItsNumberOfSessionsUntilThatIsRefused) {
  FleetMember member({});
  member.done(FleetCall::ready, 0s);
  member.done(FleetCall::health, 0s);
  EXPECT_EQ(member.next(0s, true), FleetCall::count);
  member.done(FleetCall::count, 0s);
  EXPECT_EQ(member.next(0s, true), FleetCall::look);
  member.done(FleetCall::look, 0s);
  EXPECT_EQ(member.next(0s, true), FleetCall::none);
  member.set_sessions(1, 0s);
  member.done(FleetCall::allocate, 0s);
  EXPECT_EQ(member.next(0s, true), FleetCall::count);
  member.done(FleetCall::count, 0s);
  EXPECT_EQ(member.next(1s, true), FleetCall::none);
  EXPECT_EQ(member.next(1min, false), FleetCall::count) << "the allocator may have counted who did not come";
  member.refused(FleetCall::count);
  EXPECT_EQ(member.next(0s, true), FleetCall::none);
}

TEST(AFleetMember, ThatLeavesShutsDownWhateverItsState) {
  FleetMember member({});
  member.leave();
  EXPECT_EQ(member.next(0s, false), FleetCall::shut_down);
  member.done(FleetCall::shut_down, 0s);
  EXPECT_EQ(member.next(0s, false), FleetCall::none);
}

TEST(AFleetState, IsReadFromTheSidecarsAnswer) {
  const auto state =
      read_fleet_state(R"({"spec":{"health":{"disabled":false,"period_seconds":3}},"status":{"state":"Allocated"}})");
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->allocated);
  EXPECT_EQ(state->health_period, 3s);
  const auto other = read_fleet_state(R"({"spec":{"health":{"periodSeconds":"7"}},"status":{"state":"Ready"}})");
  ASSERT_TRUE(other);
  EXPECT_FALSE(other->allocated);
  EXPECT_EQ(other->health_period, 7s);
}

TEST(AFleetState, IsNoneInWhatIsNoAnswer) {
  for (const char* const text :
       {"", "{}", "[]", "null", "{\"status\":{}}", "{\"status\":{\"state\":1}}", "{\"status\":7}"}) {
    EXPECT_FALSE(read_fleet_state(text)) << text;
  }
  const auto odd =
      read_fleet_state(R"({"spec":{"health":{"period_seconds":"99999999999999"}},"status":{"state":"Ready"}})");
  ASSERT_TRUE(odd);
  EXPECT_EQ(odd->health_period, 0s);
}

}  // namespace
}  // namespace forcebound::server
