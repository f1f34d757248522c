#include "forcebound/server/session/memory_budget.hpp"

#include <memory>
#include <string>

#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t kMebibyte = std::size_t{1} << 20U;

/// Takes from a memory that the test counts, and gives it back.
class LargeEnvironment final : public Environment {
 public:
  LargeEnvironment(std::size_t& in_use, std::size_t takes) : in_use_(in_use), takes_(takes) { in_use_ += takes_; }
  ~LargeEnvironment() override { in_use_ -= takes_; }
  LargeEnvironment(const LargeEnvironment&) = delete;
  LargeEnvironment& operator=(const LargeEnvironment&) = delete;

  Answer respond(const Motion& /*motion*/) noexcept override { return {.force = vector_of({0})}; }

 private:
  std::size_t& in_use_;
  std::size_t takes_;
};

/// Two environments, which take 10 MiB and 100 MiB for each session.
class ServerMemory : public ServerFixture {
 protected:
  void begin(std::size_t session_most, std::size_t all_most) {
    EnvironmentLibrary environments;
    environments.add(taking("small", 10 * kMebibyte));
    environments.add(taking("large", 100 * kMebibyte));
    start({.scene = "small",
           .memory = {.session_most = session_most, .all_most = all_most, .in_use = [this] { return in_use_; }}},
          std::move(environments));
  }

  EnvironmentKind taking(const std::string& name, std::size_t bytes) {
    return {.name = name, .degrees_of_freedom = {1}, .make = [this, bytes](const ClientFacts&) {
              ++made_;
              return MadeEnvironment{.environment = std::make_unique<LargeEnvironment>(in_use_, bytes),
                                     .simulated = "memory"};
            }};
  }

  void ask(const std::string& scene, std::uint16_t port) {
    auto wanted = hello(port);
    wanted.scene = scene;
    arrive(wanted, address(port));
  }

  void TearDown() override { server.reset(); }

  std::size_t in_use_ = 0;
  int made_ = 0;
};

TEST_F(ServerMemory, RefusesASceneThatTakesMoreForASessionThanIsAllowed) {
  begin(50 * kMebibyte, 0);
  for (std::uint16_t port = 1; port <= 3; ++port) {
    ask("large", port);
    const auto refusal = only_answer<wire::Refusal>();
    EXPECT_EQ(refusal.reason, wire::RefusalReason::unknown_scene);
    EXPECT_EQ(std::string(refusal.text),
              "a session in scene 'large' takes 100 MiB of memory, of 50 MiB that this server allows");
  }
  EXPECT_EQ(made_, 1) << "what it takes is known after the first";
  EXPECT_EQ(in_use_, 0U);
  ask("small", 4);
  EXPECT_NE(only_answer<wire::Welcome>().session, 0U);
}

TEST_F(ServerMemory, RefusesWhoWouldTakeMoreThanThereIsAndLetsInAgainWhenSomebodyLeft) {
  begin(kMebibyte * 1000, 25 * kMebibyte);
  ask("small", 1);
  const auto first = only_answer<wire::Welcome>().session;
  ask("small", 2);
  EXPECT_NE(only_answer<wire::Welcome>().session, 0U);
  ask("small", 3);
  const auto refusal = only_answer<wire::Refusal>();
  EXPECT_EQ(refusal.reason, wire::RefusalReason::server_full);
  EXPECT_THAT(std::string(refusal.text), AllOf(HasSubstr("30 MiB, of 25 MiB at most"), HasSubstr("try again later")));
  EXPECT_EQ(server->sessions(), 2U);
  arrive(wire::Bye{.session = first});
  (void)answers();
  ask("small", 3);
  EXPECT_NE(only_answer<wire::Welcome>().session, 0U);
}

TEST_F(ServerMemory, TakesBackWhatTheFirstOneTooManyTook) {
  begin(kMebibyte * 1000, 50 * kMebibyte);
  ask("large", 1);
  EXPECT_EQ(only_answer<wire::Refusal>().reason, wire::RefusalReason::server_full);
  EXPECT_EQ(in_use_, 0U);
  EXPECT_EQ(server->sessions(), 0U);
}

TEST(MemoryBudget, HasNoLimitsWhereMemoryIsNotKnown) {
  MemoryBudget budget({.session_most = 1, .all_most = 1});
  EXPECT_EQ(budget.refusal_of("wall").text, "");
  EXPECT_EQ(budget.refusal_of_made("wall", 0).text, "");
}

}  // namespace
}  // namespace forcebound::server
