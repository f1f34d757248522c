#include "forcebound/server/runtime/udp_server.hpp"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <thread>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/vector_of.hpp"
#include "tests/unit/server/runtime/askers.hpp"

namespace forcebound::server {
namespace {

using test::vector_of;

class Push final : public Environment {
 public:
  Answer respond(const Motion& motion) noexcept override { return {.force = -100 * motion.position}; }
};

EnvironmentLibrary pushing() {
  EnvironmentLibrary environments;
  environments.add({.name = "push", .make = [](const ClientFacts&) {
                      return MadeEnvironment{.environment = std::make_unique<Push>(), .simulated = "a push"};
                    }});
  return environments;
}

//   asker ==( UDP of this machine )== UdpServer, on a thread of its own -- an environment of one's own
TEST(UdpServer, AnswersByUdpUntilStoppedAndThenEndsItsSessions) {
  UdpServer server(listen({"127.0.0.1", 0}), {.scene = "push"}, pushing());
  Asker asker(server.address());
  std::jthread thread([&](const std::stop_token& stop) { server.run(stop); });
  const auto welcome =
      asker.ask<wire::Welcome>(wire::Hello{.client_nonce = 1, .degrees_of_freedom = 1, .period_s = 1e-3});
  EXPECT_EQ(welcome.scene, "push");
  EXPECT_EQ(welcome.simulated, "a push");
  const auto session = welcome.session;
  const auto force = asker.ask<wire::EnvironmentForce>(
      wire::MotionSample{.session = session, .sequence = 1, .position = vector_of({0.02})});
  EXPECT_EQ(force.answer.force, vector_of({-2}));
  thread.request_stop();
  const auto bye = asker.receive<wire::Bye>();
  EXPECT_EQ(bye.session, session);
  EXPECT_EQ(bye.forces_sent, 1U);
  thread.join();
  EXPECT_EQ(server.server().sessions(), 0U);
  EXPECT_EQ(server.server().counters().forces_sent, 1U);
}

TEST(UdpServer, RefusesToServeWhatItDoesNotHave) {
  EXPECT_THROW(UdpServer(listen({"127.0.0.1", 0}), {.scene = "pull"}, pushing()), std::invalid_argument);
}

TEST(UdpServer, TwoCannotHaveOneAddress) {
  const UdpServer server(listen({"127.0.0.1", 0}), {.scene = "push"}, pushing());
  EXPECT_THROW((void)listen({"127.0.0.1", server.address().port}), std::runtime_error);
}

/// The result of a request after the maker has finished.
EnvironmentLibrary::Requested request_until_done(const EnvironmentLibrary& library, EnvironmentMaker& maker,
                                                 std::string_view name) {
  EnvironmentLibrary::Requested requested = library.request(name);
  while (requested.coming) {
    std::this_thread::yield();
    maker.deliver();
    requested = library.request(name);
  }
  return requested;
}

TEST(EnvironmentMaker, MakesWhatIsAskedForAndLeavesTheLibraryToItselfWhenItEnds) {
  const EnvironmentLibrary scenes = SceneLibrary::shipped();
  {
    EnvironmentMaker maker(scenes, [](std::string_view, std::string_view why) { ADD_FAILURE() << why; });
    const auto requested = request_until_done(scenes, maker, "wall");
    ASSERT_NE(requested.found, nullptr);
    EXPECT_EQ(requested.found->name, "wall");
    EXPECT_TRUE(scenes.request("sphere").coming);
  }
  EXPECT_NE(scenes.request("sphere").found, nullptr) << "made while its asker waits";
}

TEST(EnvironmentMaker, TellsWhichSceneItCannotCompileAndWhy) {
  const EnvironmentLibrary scenes = SceneLibrary::shipped(scene::Registry{});  // no effect is known
  std::string failed;
  std::string reason;
  EnvironmentMaker maker(scenes, [&](std::string_view scene, std::string_view why) {
    failed = scene;
    reason = why;
  });
  const auto requested = request_until_done(scenes, maker, "wall");
  EXPECT_EQ(requested.found, nullptr);
  EXPECT_EQ(failed, "wall");
  EXPECT_EQ(requested.why_not, reason);
  EXPECT_NE(reason.find("scenes/wall.toml"), std::string::npos) << reason;
}

}  // namespace
}  // namespace forcebound::server
