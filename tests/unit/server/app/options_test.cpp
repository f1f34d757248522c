#include "forcebound/server/app/options.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/config/config_error.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/security/key_file.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

ProgramOptions parsed(std::vector<const char*> words) {
  words.insert(words.begin(), "forcebound-server");
  return parse_command_line(static_cast<int>(words.size()), words.data());
}

/// What is said about a command line that is refused by its words alone.
std::string refusal_of_words(const std::vector<const char*>& words) {
  try {
    (void)parsed(words);
  } catch (const program::End& end) {
    EXPECT_EQ(end.exit_code, program::kWrongUse);
    return end.text;
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return "";
}

net::Address address_of(const char* text) { return net::resolve(net::parse_endpoint(text)); }

TEST(ServerOptionsOnKeys, DemandThatSomethingBoundsWhoComesIn) {
  EXPECT_THAT(refusal_of_words({"--key", "server.key"}),
              AllOf(HasSubstr("anybody"), HasSubstr("--clients"), HasSubstr("--psk")));
  EXPECT_THAT(refusal_of_words({"--clients", "clients.toml"}), HasSubstr("--key"));
  EXPECT_EQ(parsed({"--key", "server.key", "--clients", "clients.toml"}).keys.clients, "clients.toml");
  EXPECT_EQ(parsed({"--key", "server.key", "--psk", "shared.key"}).keys.psk, "shared.key");
  EXPECT_EQ(parsed({"--psk", "shared.key"}).keys.psk, "shared.key");
}

TEST(ServerOptionsOnKeys, DoNotGoWithInsecure) {
  for (const char* const option : {"--psk", "--key"}) {
    EXPECT_THAT(refusal_of_words({option, "a.key", "--insecure"}), HasSubstr("--insecure")) << option;
  }
  EXPECT_TRUE(parsed({"--insecure"}).keys.insecure);
}

TEST(ServerOptionsOnKeys, AreNeededOffLoopbackUnlessInsecureIsSaid) {
  const auto expect = [](const KeyFiles& keys, const char* address) {
    return [keys, address] { expect_encryption(keys, address_of(address)); };
  };
  for (const char* const other : {"0.0.0.0:47800", "192.0.2.1:47800", "[::]:47800", "[2001:db8::1]:47800"}) {
    EXPECT_THAT(expect({}, other),
                ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr(other), HasSubstr("keygen"), HasSubstr("--key"),
                                                           HasSubstr("--clients"), HasSubstr("--psk"),
                                                           HasSubstr("--insecure"), Not(HasSubstr("\n")))));
    EXPECT_NO_THROW(expect({.insecure = true}, other)());
    EXPECT_NO_THROW(expect({.psk = "shared.key"}, other)());
    EXPECT_NO_THROW(expect({.key = "server.key"}, other)());
  }
  for (const char* const own : {"127.0.0.1:47800", "127.1.2.3:47800", "[::1]:47800"}) {
    EXPECT_NO_THROW(expect({}, own)()) << own;
  }
}

TEST(ServerOptionsOnKeys, SayInWordsWhetherSessionsAreEncryptedAndNoSecret) {
  const test::TemporaryFolder folder;
  const security::SecretKey secret = security::secret_key(1);
  const security::SecretKey shared = security::secret_key(2);
  const std::string key_file = folder.file("server.key");
  const std::string shared_file = folder.file("shared.key");
  security::write_secret_key(key_file, secret);
  security::write_shared_key(shared_file, shared);

  const KeyFiles both{.key = key_file, .psk = shared_file};
  const auto pair = read_keys(both);
  const std::string words = encryption_in_words(both, pair);
  EXPECT_EQ(words, "encrypted: IKpsk2, public key " + security::public_text(1));
  EXPECT_THAT(words, AllOf(Not(HasSubstr(security::to_base64(*secret))), Not(HasSubstr(security::to_base64(*shared)))));
  EXPECT_EQ(encryption_name(pair), "IKpsk2");

  const KeyFiles alone{.psk = shared_file};
  EXPECT_EQ(encryption_in_words(alone, read_keys(alone)), "encrypted: NNpsk0");
  EXPECT_EQ(encryption_name(read_keys(alone)), "NNpsk0");

  const KeyFiles insecure{.insecure = true};
  EXPECT_EQ(encryption_in_words(insecure, read_keys(insecure)), "NOT ENCRYPTED (--insecure)");
  EXPECT_EQ(encryption_in_words({}, read_keys({})), "not encrypted: this machine only");
  EXPECT_EQ(encryption_name(read_keys({})), "none");
}

TEST(ServerOptionsOnKeys, ReadTheListOfClients) {
  const test::TemporaryFolder folder;
  const std::string key_file = folder.file("server.key");
  const std::string clients = folder.file("clients.toml");
  security::write_secret_key(key_file, security::secret_key(1));
  text::write_file(clients, "[[client]]\nname = \"anna\"\npublic_key = \"" + security::public_text(7) + "\"\n");
  const auto read = read_keys({.key = key_file, .clients = clients});
  ASSERT_TRUE(read && read->clients);
  EXPECT_NE(read->clients->find(security::public_key(7)), nullptr);
  EXPECT_FALSE(read->shared.has_value());
  text::write_file(clients, text::read_file(clients) + "scenes = [\"wal\"]\n");
  EXPECT_THAT([&] { (void)read_keys({.key = key_file, .clients = clients}, {"wall"}); },
              ThrowsMessage<config::ConfigError>(AllOf(HasSubstr(clients + ":4: "), HasSubstr("no scene 'wal'"))));
}

TEST(ServerOptionsOnKeys, AreFilesWhoseRefusalTellsNoKey) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("damaged.key");
  const std::string secret = security::to_base64(security::key_bytes(1));
  security::write_secret_key(file, security::secret_key(1));
  EXPECT_THAT([&] { (void)read_keys({.psk = file}); },
              ThrowsMessage<config::ConfigError>(AllOf(HasSubstr(file), Not(HasSubstr(secret)))));
}

}  // namespace
}  // namespace forcebound::server
