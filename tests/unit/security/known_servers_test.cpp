#include "forcebound/security/known_servers.hpp"

#include <gmock/gmock.h>

#include <string>

#include "forcebound/config/config_error.hpp"
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

TEST(KnownServers, AreThoseOfTheFile) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("servers");
  text::write_file(file, "# mine\n\na:1 " + public_text(1) + "\r\n  b:2   " + public_text(2) + "\nd:4 " +
                             std::string(kPublicKeyWord) + " " + public_text(4));
  KnownServers servers = KnownServers::from_file(file);
  EXPECT_EQ(servers.find("a:1"), public_key(1));
  EXPECT_EQ(servers.find("b:2"), public_key(2));
  EXPECT_EQ(servers.find("c:3"), std::nullopt);
  EXPECT_EQ(servers.find("d:4"), public_key(4)) << "as keygen --public prints it";
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

TEST(KnownServers, LoseNothingThatOthersWroteMeanwhile) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("servers");
  KnownServers one = KnownServers::from_file(file);
  KnownServers other = KnownServers::from_file(file);
  one.expect("a:1", public_key(1), NewServers::trusted);
  other.expect("b:2", public_key(2), NewServers::trusted);
  EXPECT_EQ(text::read_file(file), "a:1 " + public_text(1) + "\nb:2 " + public_text(2) + "\n");
  EXPECT_THAT([&] { one.expect("b:2", public_key(3), NewServers::trusted); },
              ThrowsMessage<config::ConfigError>(HasSubstr("server b:2 was given another key there meanwhile")));
}

TEST(KnownServers, AreRememberedEvenIfTheyCannotBeWritten) {
  const test::TemporaryFolder folder;
  KnownServers servers = KnownServers::from_file((folder.path() / "none" / "servers").string());
  EXPECT_THROW(servers.expect("a:1", public_key(1), NewServers::trusted), config::ConfigError);
  EXPECT_NO_THROW(servers.expect("a:1", public_key(1), NewServers::trusted));
  EXPECT_THROW(servers.expect("a:1", public_key(2), NewServers::trusted), config::ConfigError);
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
              ThrowsMessage<config::ConfigError>(AllOf(HasSubstr("server a:1 has the key " + public_text(2) +
                                                                 ", but is known with the key " + public_text(1)),
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

}  // namespace
}  // namespace forcebound::security
