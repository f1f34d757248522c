#include "forcebound/server/session/admission.hpp"

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/unit/server/session/parts_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;

/// Decisions on Hellos; nothing is sent.
class DecisionOnHello : public PartsFixture {
 protected:
  Decision decide(const wire::Hello& hello, const Sender& sender = {.address = address(1)}) {
    if (!admission_) {
      EnvironmentLibrary environments(SceneLibrary::shipped());
      environments.add({.name = "shared", .sessions_max = 2, .make = [](const ClientFacts&) {
                          return MadeEnvironment{.environment = std::make_unique<OneNewton>()};
                        }});
      const Admission::Parts parts{.table = table, .capacity = capacity, .counters = counters, .random = random_};
      admission_.emplace(options, std::move(environments), parts, clock.time);
    }
    return admission_->decide(hello, sender, clock.time);
  }

  Refused refused(const wire::Hello& hello, const Sender& sender = {.address = address(1)}) {
    const Decision decision = decide(hello, sender);
    const auto* const refused = std::get_if<Refused>(&decision);
    if (refused == nullptr) ADD_FAILURE() << "another decision";
    return refused == nullptr ? Refused{} : *refused;
  }

  static wire::Hello hello_for(std::string_view scene) {
    return {.client_nonce = 7, .degrees_of_freedom = 1, .device = "wall-1dof", .period_s = 1e-3, .scene = scene};
  }

  Housekeeping housekeeping{options, table};
  Capacity capacity{options, table, housekeeping, counters};

 private:
  std::uint64_t next_id_ = 5000;
  std::function<std::uint64_t()> random_ = [this] { return next_id_ += 1000; };
  std::optional<Admission> admission_;
};

TEST_F(DecisionOnHello, OpensASessionAndGivesACopyOfTheHelloTheSame) {
  const Decision first = decide(hello_for(""));
  const auto& let_in = std::get<LetIn>(first);
  EXPECT_FALSE(let_in.repeated);
  EXPECT_EQ(let_in.session.info.scene, "wall");
  EXPECT_EQ(table.find(let_in.session.info.session), &let_in.session);
  const Decision copy = decide(hello_for(""));
  EXPECT_TRUE(std::get<LetIn>(copy).repeated);
  EXPECT_EQ(&std::get<LetIn>(copy).session, &let_in.session);
  EXPECT_EQ(counters.hellos_repeated, 1U);
  EXPECT_TRUE(link.sent.empty());
}

TEST_F(DecisionOnHello, RefusesAnUnknownSceneAndListsTheKnown) {
  const Refused unknown = refused(hello_for("wal"));
  EXPECT_EQ(unknown.reason, wire::RefusalReason::unknown_scene);
  EXPECT_THAT(unknown.text, HasSubstr("no scene 'wal', did you mean 'wall'? (known: "));
}

TEST_F(DecisionOnHello, RefusesOtherDegreesOfFreedomWithBothNumbers) {
  const Refused wrong = refused(hello_for("sphere"));
  EXPECT_EQ(wrong.reason, wire::RefusalReason::wrong_degrees_of_freedom);
  EXPECT_EQ(wrong.text, "scene 'sphere' accepts devices with 3 or 6 degrees of freedom, device 'wall-1dof' has 1");
}

TEST_F(DecisionOnHello, OffersTheAllowedScenesAlone) {
  options.scenes = {"sphere"};
  const Refused other = refused(hello_for("box"));
  EXPECT_EQ(other.reason, wire::RefusalReason::unknown_scene);
  EXPECT_EQ(other.text, "this server does not offer scene 'box' (offered: wall, sphere)");
  EXPECT_TRUE(std::holds_alternative<LetIn>(decide(hello_for("")))) << "the default";
}

TEST_F(DecisionOnHello, IsThatOfAnotherWorkerForASharedSceneThatIsThere) {
  options.worker.workers = 2;
  const std::size_t home = options.worker.home_of("shared");
  options.worker.number = 1 - home;
  EXPECT_EQ(std::get<Elsewhere>(decide(hello_for("shared"))).worker, home);
  EXPECT_EQ(table.size(), 0U);
}

}  // namespace
}  // namespace forcebound::server
