#include "forcebound/security/key_file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>
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

class KeyFile : public testing::Test {
 protected:
  /// @return a file of its owner alone
  std::string file_with(const std::string& text, ::mode_t mode = 0600) {
    const std::string path = folder_.file("key");
    text::write_file(path, text);
    EXPECT_EQ(::chmod(path.c_str(), mode), 0);
    return path;
  }

  static void expect_refused(const std::function<void()>& read, const std::string& why) {
    EXPECT_THAT(read, ThrowsMessage<config::ConfigError>(AllOf(HasSubstr(why), Not(HasSubstr("\n")))));
  }

  void expect_secret_refused(const std::string& text, const std::string& why) {
    const std::string path = file_with(text);
    expect_refused([&] { (void)read_key_pair(path); }, why);
    expect_refused([&] { (void)read_key_pair(path); }, path + ": ");
  }

  test::TemporaryFolder folder_;
  const std::string secret_ = to_base64(key_bytes(1));
};

TEST_F(KeyFile, GivesTheKeyThatWasWrittenForItsOwnerAlone) {
  const std::string path = folder_.file("anna.key");
  write_secret_key(path, secret_key(1));
  struct ::stat about {};
  ASSERT_EQ(::stat(path.c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777U, 0600U);
  const KeyPair pair = read_key_pair(path);
  EXPECT_EQ(*pair.secret, key_bytes(1));
  EXPECT_EQ(pair.public_key, key_pair_from(key_bytes(1)).public_key);

  write_shared_key(folder_.file("shared.key"), secret_key(2));
  EXPECT_EQ(*read_shared_key(folder_.file("shared.key")), key_bytes(2));
  const std::string public_key = to_base64(pair.public_key.bytes);
  EXPECT_EQ(read_public_key(file_with("forcebound-public-key " + public_key + "\n", 0644)), pair.public_key);
  EXPECT_EQ(read_public_key(public_key), pair.public_key);
}

TEST_F(KeyFile, MayHaveComments) {
  const std::string path = file_with("# of anna\r\n\r\n  forcebound-secret-key  " + secret_ + " \r\n# the end");
  EXPECT_EQ(*read_key_pair(path).secret, key_bytes(1));
}

TEST_F(KeyFile, IsRefusedWhereOthersMayUseIt) {
  for (const ::mode_t mode : {0604U, 0644U, 0620U, 0660U, 0650U, 0601U, 0666U, 0777U}) {
    const std::string path = file_with("forcebound-secret-key " + secret_ + "\n", mode);
    expect_refused([&] { (void)read_key_pair(path); }, "accepted is mode 0600");
    expect_refused([&] { (void)read_shared_key(path); }, "others than its owner may use it");
  }
  const std::string path = file_with("forcebound-secret-key " + secret_ + "\n", 0644);
  EXPECT_THAT([&] { (void)read_key_pair(path); },
              ThrowsMessage<config::ConfigError>(
                  StartsWith(path + ": others than its owner may use it (mode 0644), but it holds a secret")));
  EXPECT_EQ(*read_key_pair(file_with("forcebound-secret-key " + secret_ + "\n", 0400)).secret, key_bytes(1));
}

// As Kubernetes gives a secret to who is not root: fsGroup, and defaultMode 0440.
TEST_F(KeyFile, OfRootMayBeReadByOneGroupOfThisProcess) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can make files of other groups";
  const std::string path = file_with("forcebound-secret-key " + secret_ + "\n");
  const auto of = [&](::uid_t user, ::gid_t group, ::mode_t mode) {
    ASSERT_EQ(::chown(path.c_str(), user, group), 0);
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
  };
  constexpr ::gid_t kOther = 54321;
  for (const ::mode_t mode : {0440U, 0640U, 0400U}) {
    of(0, ::getegid(), mode);
    EXPECT_EQ(*read_key_pair(path).secret, key_bytes(1)) << mode;
  }
  for (const ::mode_t mode : {0460U, 0450U, 0444U, 0441U, 0640U | 0004U}) {
    of(0, ::getegid(), mode);
    expect_refused([&] { (void)read_key_pair(path); }, "others than its owner may use it");
  }
  of(0, kOther, 0440);
  expect_refused([&] { (void)read_key_pair(path); },
                 "mode 0440, if its group is one of this process's (it is of user 0 and group 54321)");
  of(kOther, ::getegid(), 0440);
  expect_refused([&] { (void)read_key_pair(path); }, "others than its owner may use it");
}

TEST_F(KeyFile, IsNeverReplaced) {
  const std::string path = folder_.file("key");
  write_secret_key(path, secret_key(1));
  expect_refused([&] { write_secret_key(path, secret_key(2)); }, "it is there already and is not replaced");
  expect_refused([&] { write_shared_key(path, secret_key(2)); }, "it is there already and is not replaced");
  EXPECT_EQ(*read_key_pair(path).secret, key_bytes(1));
  expect_refused([&] { write_secret_key(folder_.file("none/key"), secret_key(2)); },
                 "cannot be written: No such file or directory");
}

/// Files get no longer than this, as on a full disk.
class ShortFiles {
 public:
  explicit ShortFiles(::rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before_), 0);
    const ::rlimit shorter{bytes, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &shorter), 0);
  }
  ~ShortFiles() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  ShortFiles(const ShortFiles&) = delete;
  ShortFiles& operator=(const ShortFiles&) = delete;

 private:
  ::rlimit before_{};
};

TEST_F(KeyFile, IsNotLeftBehindInPart) {
  const std::string path = folder_.file("anna.key");
  std::string why;
  {
    const ShortFiles full(20);
    try {
      write_secret_key(path, secret_key(1));
    } catch (const config::ConfigError& error) {
      why = error.what();
    }
  }
  EXPECT_THAT(why, AllOf(StartsWith(path), HasSubstr("cannot be written: ")));
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(KeyFile, IsRefusedForWhatIsNoKeyOrAnother) {
  expect_secret_refused("", "it holds no key; accepted is one line 'forcebound-secret-key KEY', KEY in base64");
  expect_secret_refused("# nothing\n", "it holds no key");
  expect_secret_refused(secret_, "it holds no key");
  expect_secret_refused("forcebound-secret-key", "it holds no key");
  expect_secret_refused("forcebound-secret-key " + secret_ + "\nforcebound-secret-key " + secret_, "it holds no key");
  expect_secret_refused("forcebound-shared-key " + secret_,
                        "it holds a forcebound-shared-key, but here a forcebound-secret-key is wanted");
  expect_secret_refused("forcebound-public-key " + secret_,
                        "it holds a forcebound-public-key, but here a forcebound-secret-key is wanted");
  expect_secret_refused("forcebound-secret-key " + secret_.substr(1), "its forcebound-secret-key is damaged");
  expect_secret_refused("forcebound-secret-key " + secret_ + "=", "its forcebound-secret-key is damaged");
  expect_secret_refused("forcebound-secret-key " + std::string(44, '!'), "its forcebound-secret-key is damaged");
  expect_secret_refused(std::string(5000, '#'), "it is longer than 4096 bytes");
  expect_secret_refused(std::string("\0\x1b[2J", 5), "it holds no key");
}

TEST_F(KeyFile, IsNeverQuoted) {
  const std::string path = file_with("forcebound-secret-key " + secret_ + "x\n");
  EXPECT_THAT([&] { (void)read_key_pair(path); },
              ThrowsMessage<config::ConfigError>(Not(HasSubstr(secret_.substr(0, 8)))));
}

TEST_F(KeyFile, IsARegularFile) {
  const std::string pipe = folder_.file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_refused([&] { (void)read_key_pair(pipe); }, "cannot be read: it is no regular file");
  expect_refused([&] { (void)read_key_pair(folder_.path().string()); }, "cannot be read: it is no regular file");
  expect_refused([&] { (void)read_key_pair(folder_.file("none")); }, "cannot be read: No such file or directory");
}

TEST(PublicKeyText, IsRefusedForAPointOfLowOrder) {
  EXPECT_FALSE(public_key_from(to_base64(KeyBytes{})));
  EXPECT_FALSE(public_key_from(to_base64(KeyBytes{std::byte{1}})));
  EXPECT_FALSE(public_key_from(""));
  EXPECT_TRUE(public_key_from(to_base64(key_pair_from(key_bytes(1)).public_key.bytes)));
}

TEST(PublicKeyText, IsReadAsKeygenPrintsIt) {
  const PublicKey key = key_pair_from(key_bytes(1)).public_key;
  const std::string printed = std::string(kPublicKeyWord) + " " + to_base64(key.bytes);
  EXPECT_EQ(public_key_from(printed), key);
  EXPECT_EQ(read_public_key(printed), key);
  EXPECT_FALSE(public_key_from(std::string(kPublicKeyWord) + to_base64(key.bytes)));
  EXPECT_FALSE(public_key_from(std::string(kPublicKeyWord) + " " + printed));
}

// Found by fuzzing: libsodium read the byte 0x82 as 'M', so that one key could be written in several ways.
TEST(PublicKeyText, IsRefusedWithAByteBeyondAscii) {
  const std::string text = to_base64(key_pair_from(key_bytes(1)).public_key.bytes);
  for (int byte = 0x80; byte <= 0xff; ++byte) {
    for (std::size_t place = 0; place < text.size(); ++place) {
      std::string other = text;
      other[place] = static_cast<char>(byte);
      EXPECT_FALSE(public_key_from(other)) << "byte " << byte << " at " << place;
    }
  }
}

TEST(Wipe, LeavesZeros) {
  KeyBytes key = key_bytes(1);
  wipe(key.data(), key.size());
  EXPECT_EQ(key, KeyBytes{});
}

}  // namespace
}  // namespace forcebound::security
