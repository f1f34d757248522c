#include "forcebound/client/ros2/wrench_inbox.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <thread>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::ros2 {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

constexpr std::uint64_t kFirst = 7;
constexpr std::uint64_t kSecond = 8;

Verdict receive(WrenchInbox& inbox, Nanoseconds arrival, std::uint64_t publisher = kFirst, double x_N = 1,
                std::string_view frame = {}) {
  return inbox.receive(
      {.publisher = publisher, .frame = frame, .wrench = {.force_N = {x_N, 0, 0}, .arrival = arrival}});
}

TEST(WrenchInbox, GivesTheNewestThatWasTaken) {
  WrenchInbox inbox("base", 1s);
  EXPECT_FALSE(inbox.newest().has_value());
  EXPECT_EQ(receive(inbox, 1ms, kFirst, 1), Verdict::taken);
  EXPECT_EQ(receive(inbox, 2ms, kFirst, 2), Verdict::taken);
  ASSERT_TRUE(inbox.newest().has_value());
  EXPECT_EQ(inbox.newest()->force_N.x(), 2);
  EXPECT_EQ(inbox.newest()->arrival, 2ms);
}

TEST(WrenchInbox, RefusesWhatIsNotFinite) {
  WrenchInbox inbox("base", 1s);
  EXPECT_EQ(receive(inbox, 1ms, kFirst, std::numeric_limits<double>::quiet_NaN()), Verdict::not_finite);
  Wrench torque;
  torque.torque_N_m.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(inbox.receive({.publisher = kFirst, .frame = {}, .wrench = torque}), Verdict::not_finite);
  EXPECT_FALSE(inbox.newest().has_value());
  EXPECT_THAT(inbox.counts(), ElementsAre(0, 2, 0, 0));
}

TEST(WrenchInbox, TakesOurFrameAndNoFrameAlone) {
  WrenchInbox inbox("base", 1s);
  EXPECT_EQ(receive(inbox, 1ms, kFirst, 1, "base"), Verdict::taken);
  EXPECT_EQ(receive(inbox, 2ms, kFirst, 1, ""), Verdict::taken);
  EXPECT_EQ(inbox.other_frame(), "");
  EXPECT_EQ(receive(inbox, 3ms, kFirst, 1, "tool0"), Verdict::in_another_frame);
  EXPECT_EQ(receive(inbox, 4ms, kFirst, 1, "world"), Verdict::in_another_frame);
  EXPECT_EQ(inbox.other_frame(), "tool0") << "the first";
}

TEST(WrenchInbox, CutsTheNameOfAFrameThatIsLong) {
  WrenchInbox inbox("base", 1s);
  const std::string name(1000, 'x');
  EXPECT_EQ(receive(inbox, 1ms, kFirst, 1, name), Verdict::in_another_frame);
  EXPECT_EQ(inbox.other_frame(), name.substr(0, 64));
}

TEST(WrenchInbox, HearsTheFirstPublisherUntilItIsSilentForThePatience) {
  WrenchInbox inbox("base", 1s);
  EXPECT_EQ(receive(inbox, 10ms, kFirst), Verdict::taken);
  EXPECT_EQ(receive(inbox, 11ms, kSecond), Verdict::of_another_publisher);
  EXPECT_EQ(receive(inbox, 1009ms, kSecond), Verdict::of_another_publisher);
  EXPECT_EQ(receive(inbox, 1010ms, kSecond), Verdict::taken);
  EXPECT_EQ(receive(inbox, 1011ms, kFirst), Verdict::of_another_publisher);
  EXPECT_THAT(inbox.counts(), ElementsAre(2, 0, 3, 0));
}

TEST(WrenchInbox, APublisherOfNonsenseKeepsNobodyOut) {
  WrenchInbox inbox("base", 1s);
  EXPECT_EQ(receive(inbox, 1ms, kFirst, std::numeric_limits<double>::infinity()), Verdict::not_finite);
  EXPECT_EQ(receive(inbox, 2ms, kSecond), Verdict::taken);
}

TEST(WrenchInbox, GivesWholeWrenchesFromThreadToThread) {
  WrenchInbox inbox("base", 1s);
  constexpr int kMany = 20000;
  std::jthread dds([&inbox] {
    for (int i = 1; i <= kMany; ++i) {
      Wrench wrench{.arrival = Nanoseconds{i}};
      wrench.force_N.setConstant(i);
      wrench.torque_N_m.setConstant(i);
      (void)inbox.receive({.publisher = kFirst, .frame = {}, .wrench = wrench});
    }
  });
  for (Nanoseconds last{0}; last < Nanoseconds{kMany};) {
    const auto& wrench = inbox.newest();
    if (!wrench) continue;
    const auto expected = static_cast<double>(wrench->arrival.count());
    ASSERT_GE(wrench->arrival, last);
    ASSERT_EQ(wrench->force_N, Eigen::Vector3d::Constant(expected));
    ASSERT_EQ(wrench->torque_N_m, Eigen::Vector3d::Constant(expected));
    last = wrench->arrival;
  }
}

TEST(WrenchInbox, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  WrenchInbox inbox("base", 1s);
  const test::AllocationGuard guard;
  (void)receive(inbox, 1ms, kFirst, 1, "base");
  (void)receive(inbox, 1ms, kFirst, 1, "tool0");
  (void)inbox.newest();
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::ros2
