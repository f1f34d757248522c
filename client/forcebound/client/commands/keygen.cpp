#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "forcebound/client/commands/commands.hpp"
#include "forcebound/security/key_file.hpp"
#include "forcebound/security/random.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client::commands {
namespace {

struct KeygenOptions {
  std::string file;
  bool shared = false;
  bool show_public = false;
};

/// As files of public keys have it.
void print_public(const security::KeyPair& pair) {
  std::printf("%s %s\n", security::kPublicKeyWord.data(), security::to_base64(pair.public_key.bytes).c_str());
}

void run_keygen(const KeygenOptions& options) {
  if (options.show_public) {
    print_public(security::read_key_pair(options.file));
    return;
  }
  security::SecretKey random;
  security::fill_with_random(*random);
  const std::string file = text::printable(options.file);
  if (options.shared) {
    security::write_shared_key(options.file, random);
    std::printf("%s: a new key for both ends to share; nobody else may see it\n", file.c_str());
    return;
  }
  security::write_secret_key(options.file, random);
  const security::KeyPair pair = security::key_pair_from(*random);
  std::printf("%s: a new secret key, which stays on this machine\npublic key, for others: %s\n", file.c_str(),
              security::to_base64(pair.public_key.bytes).c_str());
}

}  // namespace

void add_keygen(CLI::App& app) {
  auto options = std::make_shared<KeygenOptions>();
  CLI::App* command = app.add_subcommand("keygen", "A new key: of a client, a server, or shared");
  command
      ->add_option("file", options->file,
                   "new file for the key, which only its owner may read; with --public one that is there")
      ->required()
      ->type_name("FILE");
  auto* const shared =
      command->add_flag("--shared", options->shared, "a key that both ends have, in place of a pair of keys");
  command
      ->add_flag("--public", options->show_public,
                 "print the public key of a secret one, as files of public keys have it, and write nothing")
      ->excludes(shared);
  command->footer(
      "Draws a key from the system's random numbers. A file that is there already is never replaced. The public key "
      "follows from the secret one and may be known to all.\n"
      "\n"
      "Examples:\n"
      "  forcebound keygen server.key\n"
      "  forcebound keygen shared.key --shared\n"
      "  forcebound keygen server.key --public >server.pub");
  command->callback([options] { run_keygen(*options); });
}

}  // namespace forcebound::client::commands
