#include <gtest/gtest.h>

#include "forcebound/client/session/session.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/counting_law.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

struct WithCountLog {
  test::CountLog log;
};

class SessionWithServerSideLaw : private WithCountLog, public SessionTest {
 protected:
  SessionWithServerSideLaw() : SessionTest("counting", test::laws_with_counting(log)) {}

  wire::EnvironmentForce saying(const wire::MotionSample& motion, double number) {
    wire::EnvironmentForce force = answer(motion, -1);
    force.server_law_numbers = control::ServerLawNumbers::Constant(2, number);
    return force;
  }
  [[nodiscard]] const test::CountLog& heard() const { return log; }
};

TEST_F(SessionWithServerSideLaw, RequestsItAndSendsItEachMotionWithTheStateOfTheTickBefore) {
  tick();
  const auto hellos = sent<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  EXPECT_EQ(hellos[0].server_law, "counting");
  arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce, .session = kSession});
  tick();
  tick();
  tick();
  const auto motions = sent<wire::MotionSample>();
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[0].server_law_numbers, control::ServerLawNumbers::Constant(1, 2));
  EXPECT_EQ(motions[1].server_law_numbers, control::ServerLawNumbers::Constant(1, 3));
}

TEST_F(SessionWithServerSideLaw, ReceivesOnlyItsDataOfTheNewestForce) {
  connect();
  for (int i = 0; i < 4; ++i) tick();
  const auto motions = sent<wire::MotionSample>();
  const auto first = saying(motions.at(0), 1);
  const auto second = saying(motions.at(1), 2);
  const auto third = saying(motions.at(2), 3);
  auto of_another = saying(motions.at(3), 4);
  of_another.session = kSession + 1;
  arrive(second);
  arrive(second);
  arrive(first);
  arrive(of_another);
  arrive(third);
  tick();
  EXPECT_EQ(heard().answers_received, (std::vector<double>{2, 3}));
}

TEST_F(SessionWithServerSideLaw, LearnsThatAnotherServerSideLawBeginsWithEachSession) {
  connect();
  ASSERT_EQ(heard().server_side_began, (std::vector<std::size_t>{0}));
  tick();
  arrive(saying(sent<wire::MotionSample>().back(), 1));
  arrive(wire::Refusal{.session = kSession, .reason = wire::RefusalReason::unknown_session});
  tick();
  const auto hellos = sent<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  EXPECT_EQ(hellos[0].server_law, "counting");
  arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce, .session = kSession + 1});
  arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce, .session = kSession + 1});
  tick();
  EXPECT_EQ(heard().server_side_began, (std::vector<std::size_t>{0, 1}));
}

TEST_F(SessionWithServerSideLaw, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  connect();
  tick();
  const auto bytes = codec.encode(saying(sent<wire::MotionSample>().at(0), 1));
  const std::vector<std::byte> force(bytes.begin(), bytes.end());
  link.reserve(1);
  link.keep = false;
  const test::AllocationGuard guard;
  link.arrive_again(force, kServer);
  for (int i = 0; i < 10; ++i) tick();
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(heard().answers_received.size(), 1U);
}

}  // namespace
}  // namespace forcebound::client
