#include <gmock/gmock.h>

#include <string>

#include "forcebound/config/config_error.hpp"
#include "forcebound/security/allowed_clients.hpp"
#include "forcebound/security/known_servers.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::security {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

PublicKey public_key(std::uint8_t number) { return key_pair_from(key_bytes(number)).public_key; }
std::string public_text(std::uint8_t number) { return to_base64(public_key(number).bytes); }

TEST(KnownServers, AreThoseOfTheFile) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("servers");
  text::write_file(file, "# mine\n\na:1 " + public_text(1) + "\r\n  b:2   " + public_text(2));
  KnownServers servers = KnownServers::from_file(file);
  EXPECT_EQ(servers.find("a:1"), public_key(1));
  EXPECT_EQ(servers.find("b:2"), public_key(2));
  EXPECT_EQ(servers.find("c:3"), std::nullopt);
  EXPECT_NO_THROW(servers.expect("a:1", public_key(1), NewServers::refused));
}

TEST(KnownServers, RefuseANewOneUnlessAsked) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("servers");
  KnownServers servers = KnownServers::from_file(file);
  EXPECT_THAT([&] { servers.expect("a:1", public_key(1), NewServers::refused); },
              ThrowsMessage<config::ConfigError>(AllOf(StartsWith(file + ": server a:1 is not named there"),
                                                       HasSubstr("add the line 'a:1 " + public_text(1) + "'"),
                                                       HasSubstr("or give --trust-new"), Not(HasSubstr("\n")))));
  EXPECT_EQ(KnownServers::from_file(file).find("a:1"), std::nullopt);
  servers.expect("a:1", public_key(1), NewServers::trusted);
  servers.expect("b:2", public_key(2), NewServers::trusted);
  EXPECT_EQ(text::read_file(file), "a:1 " + public_text(1) + "\nb:2 " + public_text(2) + "\n");
  EXPECT_EQ(KnownServers::from_file(file).find("b:2"), public_key(2));
}

TEST(KnownServers, KeepWhatAUserWrote) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("servers");
  text::write_file(file, "# mine");
  KnownServers::from_file(file).expect("a:1", public_key(1), NewServers::trusted);
  EXPECT_EQ(text::read_file(file), "# mine\na:1 " + public_text(1) + "\n");
}

TEST(KnownServers, RefuseAnotherKeyEvenIfAskedToTrustNewOnes) {
  const test::TemporaryFolder folder;
  KnownServers servers = KnownServers::from_file(folder.file("servers"));
  servers.expect("a:1", public_key(1), NewServers::trusted);
  EXPECT_THAT([&] { servers.expect("a:1", public_key(2), NewServers::trusted); },
              ThrowsMessage<config::ConfigError>(
                  AllOf(HasSubstr("server a:1 has the key " + public_text(2) + ", but is known with the key " +
                                  public_text(1)),
                        Not(HasSubstr("\n")))));
  EXPECT_EQ(servers.find("a:1"), public_key(1));
}

TEST(KnownServers, RefuseANameThatWouldBreakTheFile) {
  const test::TemporaryFolder folder;
  KnownServers servers = KnownServers::from_file(folder.file("servers"));
  for (const std::string name : {"", "a b", "#a:1", "a:1\nb:2", "a\x1b"}) {
    EXPECT_THAT([&] { servers.expect(name, public_key(1), NewServers::trusted); },
                ThrowsMessage<config::ConfigError>(HasSubstr("is no name for a server; accepted is HOST:PORT")));
  }
}

TEST(KnownServers, SayWhichLineIsWrong) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("servers");
  const auto expect_refused = [&](const std::string& text, const std::string& why) {
    text::write_file(file, text);
    EXPECT_THAT([&] { (void)KnownServers::from_file(file); },
                ThrowsMessage<config::ConfigError>(StartsWith(file + ":2: " + why)));
  };
  expect_refused("\na:1\n", "no server with its key; accepted is 'HOST:PORT KEY'");
  expect_refused("\na:1 " + public_text(1) + " more\n", "no server with its key");
  expect_refused("\na:1 AAAA\n", "this is no public key");
  expect_refused("a:1 " + public_text(1) + "\na:1 " + public_text(2), "the server is named above already");
  EXPECT_THROW((void)KnownServers::from_file(folder.path().string()), config::ConfigError);
}

TEST(AllowedClients, AreThoseOfTheFile) {
  const AllowedClients clients = AllowedClients::parse("[[client]]\nname = 'anna'\npublic_key = '" + public_text(1) +
                                                           "'\nscenes = ['wall', 'palpation']\nrate_per_s_max = 500\n"
                                                           "[[client]]\nname = 'ben'\npublic_key = '" +
                                                           public_text(2) + "'\n",
                                                       "clients.toml");
  ASSERT_EQ(clients.all().size(), 2U);
  const AllowedClient* const anna = clients.find(public_key(1));
  ASSERT_NE(anna, nullptr);
  EXPECT_EQ(anna->name, "anna");
  EXPECT_EQ(anna->rate_per_s_max, 500.0);
  EXPECT_TRUE(anna->may_use("wall"));
  EXPECT_FALSE(anna->may_use("soft_pad"));
  const AllowedClient* const ben = clients.find(public_key(2));
  ASSERT_NE(ben, nullptr);
  EXPECT_EQ(ben->rate_per_s_max, std::nullopt);
  EXPECT_TRUE(ben->may_use("soft_pad"));
  EXPECT_EQ(clients.find(public_key(3)), nullptr);
  EXPECT_TRUE(AllowedClients::parse("", "clients.toml").all().empty()) << "nobody is let in";
}

TEST(AllowedClients, SayWhatIsWrongAndWhere) {
  const auto expect_refused = [](const std::string& more, const std::string& why) {
    EXPECT_THAT([&] { (void)AllowedClients::parse("[[client]]\nname = 'anna'\n" + more, "clients.toml"); },
                ThrowsMessage<config::ConfigError>(
                    AllOf(StartsWith("clients.toml:"), HasSubstr(why), Not(HasSubstr("\n")))));
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
  expect_refused(key + "scene = ['wall']\n", "did you mean");
  expect_refused(key + "[[client]]\nname = 'ben'\n" + key, "client 'anna' has this one");
  expect_refused(key + "[[client]]\nname = 'anna'\npublic_key = '" + public_text(2) + "'\n", "anna");
  EXPECT_THROW((void)AllowedClients::from_file("/nonexistent/clients.toml"), config::ConfigError);
}

}  // namespace
}  // namespace forcebound::security
