#include "forcebound/client/security/identity_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "forcebound/config/config_error.hpp"
#include "forcebound/security/key_file.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::client {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class IdentityFilesTest : public testing::Test {
 protected:
  IdentityFilesTest() {
    security::write_secret_key(key_, security::secret_key(1));
    security::write_shared_key(shared_, security::secret_key(3));
  }

  test::TemporaryFolder folder_;
  std::uint8_t next_ = 1;
  Handshaker::FillRandom fill_ = [this](std::span<std::byte> bytes) { std::ranges::fill(bytes, std::byte{next_++}); };
  std::string key_ = folder_.file("my.key");
  std::string shared_ = folder_.file("shared.key");
  std::string known_ = folder_.file("known");
};

TEST_F(IdentityFilesTest, OfASharedKeyAloneIsNNpsk0) {
  const Identity identity = read_identity({.shared_key = shared_}, "a:1", fill_);
  EXPECT_EQ(identity.pattern, security::Pattern::nn_psk0);
  EXPECT_TRUE(identity.shared.has_value());
  EXPECT_FALSE(identity.own.has_value());
}

TEST_F(IdentityFilesTest, OfAServersKeyIsIKpsk2WithANewKeyForEachRun) {
  const IdentityFiles files{.server_key = security::public_text(2)};
  const Identity first = read_identity(files, "a:1", fill_);
  const Identity second = read_identity(files, "a:1", fill_);
  EXPECT_EQ(first.pattern, security::Pattern::ik_psk2);
  EXPECT_EQ(first.server_key, security::public_key(2));
  EXPECT_NE(first.own->public_key, second.own->public_key);
}

TEST_F(IdentityFilesTest, ReadsTheOwnKeyAndTheKnownServers) {
  const Identity identity =
      read_identity({.key = key_, .known_servers = known_, .shared_key = shared_, .trust_new = true}, "a:1", fill_);
  EXPECT_EQ(identity.own->public_key, security::public_key(1));
  EXPECT_TRUE(identity.known.has_value());
  EXPECT_TRUE(identity.shared.has_value());
  EXPECT_EQ(identity.new_servers, security::NewServers::trusted);
}

TEST_F(IdentityFilesTest, RefuseAServersKeyBesideKnownServers) {
  EXPECT_THAT(
      [&] { (void)read_identity({.server_key = security::public_text(2), .known_servers = known_}, "a:1", fill_); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("--known-servers and --trust-new go without it")));
}

TEST_F(IdentityFilesTest, RefuseAKeyThatAnybodyCanRead) {
  ASSERT_EQ(::chmod(key_.c_str(), 0644), 0);
  EXPECT_THAT([&] { (void)read_identity({.key = key_, .known_servers = known_}, "a:1", fill_); },
              ThrowsMessage<config::ConfigError>(HasSubstr(key_)));
}

TEST(KnownServersFile, IsAmongTheUsersSettingsOrElseInTheHome) {
  const auto file_with = [](const char* settings, const char* home) {
    ::setenv("XDG_CONFIG_HOME", settings, 1);
    ::setenv("HOME", home, 1);
    return default_known_servers();
  };
  const std::string before = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "";
  EXPECT_EQ(file_with("/settings", "/home/anna"), "/settings/forcebound/known_servers");
  EXPECT_EQ(file_with("", "/home/anna"), "/home/anna/.config/forcebound/known_servers");
  EXPECT_EQ(file_with("", ""), "");
  ::unsetenv("XDG_CONFIG_HOME");
  EXPECT_EQ(default_known_servers(), "");
  ::setenv("HOME", "/home/anna", 1);
  EXPECT_EQ(default_known_servers(), "/home/anna/.config/forcebound/known_servers");
  ::unsetenv("HOME");
  EXPECT_EQ(default_known_servers(), "");
  ::setenv("HOME", before.c_str(), 1);
}

TEST_F(IdentityFilesTest, AreNoneUnlessSomethingIsGiven) {
  EXPECT_FALSE(IdentityFiles{}.any());
  EXPECT_TRUE(IdentityFiles{.trust_new = true}.any());
}

}  // namespace
}  // namespace forcebound::client
