#include "forcebound/security/allowed_clients.hpp"

#include <gmock/gmock.h>

#include <string>

#include "forcebound/config/config_error.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::security {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

TEST(AllowedClients, AreThoseOfTheFile) {
  const AllowedClients clients = AllowedClients::parse("[[client]]\nname = 'anna'\npublic_key = '" + public_text(1) +
                                                           "'\nscenes = ['wall', 'palpation']\nrate_per_s_max = 500\n"
                                                           "sessions_max = 3\n"
                                                           "[[client]]\nname = 'ben'\npublic_key = '" +
                                                           public_text(2) + "'\n",
                                                       "clients.toml");
  ASSERT_EQ(clients.all().size(), 2U);
  const AllowedClient* const anna = clients.find(public_key(1));
  ASSERT_NE(anna, nullptr);
  EXPECT_EQ(anna->name, "anna");
  EXPECT_EQ(anna->rate_per_s_max, 500.0);
  EXPECT_EQ(anna->sessions_max, 3U);
  EXPECT_TRUE(anna->may_use("wall"));
  EXPECT_FALSE(anna->may_use("soft_pad"));
  const AllowedClient* const ben = clients.find(public_key(2));
  ASSERT_NE(ben, nullptr);
  EXPECT_EQ(ben->rate_per_s_max, std::nullopt);
  EXPECT_EQ(ben->sessions_max, std::nullopt);
  EXPECT_TRUE(ben->may_use("soft_pad"));
  EXPECT_EQ(clients.find(public_key(3)), nullptr);
  EXPECT_TRUE(AllowedClients::parse("", "clients.toml").all().empty()) << "nobody is let in";
}

TEST(AllowedClients, SayWhatIsWrongAndWhere) {
  const auto expect_refused = [](const std::string& more, const std::string& why) {
    EXPECT_THAT(
        [&] { (void)AllowedClients::parse("[[client]]\nname = 'anna'\n" + more, "clients.toml"); },
        ThrowsMessage<config::ConfigError>(AllOf(StartsWith("clients.toml:"), HasSubstr(why), Not(HasSubstr("\n")))));
  };
  const std::string key = "public_key = '" + public_text(1) + "'\n";
  expect_refused("", "public_key");
  expect_refused("public_key = 'AAAA'\n", "public_key must be a public key: 44 characters of base64");
  expect_refused("public_key = '" + to_base64(KeyBytes{}) + "'\n", "public_key must be a public key");
  expect_refused(key + "scenes = []\n", "scenes must be a list of at least one scene's name");
  expect_refused(key + "scenes = 'wall'\n", "scenes must be a list of at least one scene's name");
  expect_refused(key + "scenes = [1]\n", "scenes must be a list of at least one scene's name");
  expect_refused(key + "rate_per_s_max = 0\n", "rate_per_s_max must be");
  expect_refused(key + "rate_per_s_max = nan\n", "rate_per_s_max must be");
  expect_refused(key + "sessions_max = 0\n", "sessions_max must be");
  expect_refused(key + "sessions_max = 1.5\n", "sessions_max must be");
  expect_refused(key + "scene = ['wall']\n", "did you mean");
  expect_refused(key + "[[client]]\nname = 'ben'\n" + key, "client 'anna' has this one");
  expect_refused(key + "[[client]]\nname = 'anna'\npublic_key = '" + public_text(2) + "'\n", "anna");
  EXPECT_THROW((void)AllowedClients::from_file("/nonexistent/clients.toml"), config::ConfigError);
}

TEST(AllowedClients, MayBeLetIntoScenesThatTheServerHasAlone) {
  const std::string text =
      "[[client]]\nname = 'anna'\npublic_key = '" + public_text(1) + "'\nscenes = ['wall', 'spher']\n";
  EXPECT_THAT(
      [&] {
        (void)AllowedClients::parse(text, "clients.toml", {"sphere", "wall"});
      },
      ThrowsMessage<config::ConfigError>(
          "clients.toml:4: client 'anna': scenes: no scene 'spher', did you mean 'sphere'? (known: sphere, "
          "wall)"));
  EXPECT_NO_THROW((void)AllowedClients::parse(text, "clients.toml", {"spher", "wall"}));
}

}  // namespace
}  // namespace forcebound::security
