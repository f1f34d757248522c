#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <string>

#include "forcebound/client/commands/commands.hpp"
#include "forcebound/config/config_error.hpp"
#include "forcebound/security/key_file.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::client::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// What it prints.
std::string keygen(const std::string& arguments) {
  CLI::App program{"test"};
  add_keygen(program);
  testing::internal::CaptureStdout();
  try {
    program.parse("keygen " + arguments);
  } catch (...) {
    (void)testing::internal::GetCapturedStdout();
    throw;
  }
  return testing::internal::GetCapturedStdout();
}

TEST(KeygenCommand, WritesASecretKeyAndPrintsThePublicOneAlone) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("anna.key");
  const std::string printed = keygen(file);
  const security::KeyPair pair = security::read_key_pair(file);
  EXPECT_THAT(printed, AllOf(HasSubstr(security::to_base64(pair.public_key.bytes)),
                             Not(HasSubstr(security::to_base64(*pair.secret)))));
}

TEST(KeygenCommand, WritesAnotherKeyEachTime) {
  const test::TemporaryFolder folder;
  (void)keygen(folder.file("one.key"));
  (void)keygen(folder.file("other.key"));
  EXPECT_NE(*security::read_key_pair(folder.file("one.key")).secret,
            *security::read_key_pair(folder.file("other.key")).secret);
}

TEST(KeygenCommand, WritesASharedKeyAndNeverPrintsIt) {
  const test::TemporaryFolder folder;
  const std::string printed = keygen(folder.file("shared.key") + " --shared");
  const security::SecretKey key = security::read_shared_key(folder.file("shared.key"));
  EXPECT_THAT(printed, Not(HasSubstr(security::to_base64(*key))));
}

TEST(KeygenCommand, PrintsThePublicKeyOfASecretOneAsAFileHasIt) {
  const test::TemporaryFolder folder;
  (void)keygen(folder.file("anna.key"));
  const security::KeyPair pair = security::read_key_pair(folder.file("anna.key"));
  const std::string printed = keygen(folder.file("anna.key") + " --public");
  EXPECT_EQ(printed, "forcebound-public-key " + security::to_base64(pair.public_key.bytes) + "\n");
  text::write_file(folder.file("anna.pub"), printed);
  EXPECT_EQ(security::read_public_key(folder.file("anna.pub")), pair.public_key);
  EXPECT_THROW((void)keygen(folder.file("nobody.key") + " --public"), config::ConfigError);
  EXPECT_THROW((void)keygen(folder.file("shared.key") + " --public --shared"), CLI::ParseError);
}

TEST(KeygenCommand, ReplacesNoKey) {
  const test::TemporaryFolder folder;
  (void)keygen(folder.file("anna.key"));
  EXPECT_THROW((void)keygen(folder.file("anna.key")), config::ConfigError);
  EXPECT_THROW((void)keygen(folder.file("anna.key") + " --shared"), config::ConfigError);
  EXPECT_NO_THROW((void)security::read_key_pair(folder.file("anna.key")));
}

}  // namespace
}  // namespace forcebound::client::commands
