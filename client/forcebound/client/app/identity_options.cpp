#include "forcebound/client/app/identity_options.hpp"

#include <CLI/CLI.hpp>

#include "forcebound/program/command_line.hpp"

namespace forcebound::client {

void add_identity_options(CLI::App& app, IdentityFiles& files) {
  app.add_option("--key", files.key,
                 "encrypt; file of this client's secret key, as forcebound keygen writes it; default: a new one")
      ->check(program::not_empty())
      ->type_name("FILE");
  app.add_option("--server-key", files.server_key, "encrypt; the server's public key, or its file")
      ->check(program::not_empty())
      ->type_name("KEY|FILE");
  app.add_option("--known-servers", files.known_servers,
                 "encrypt; file of servers and their public keys; default, where keys are used: "
                 "forcebound/known_servers in the user's settings folder")
      ->check(program::not_empty())
      ->type_name("FILE");
  app.add_flag("--trust-new", files.trust_new,
               "encrypt; believe the key of a server that is not known yet, and add it to the known servers");
  app.add_option("--psk", files.shared_key,
                 "encrypt; file of a key that the server has too; alone, or beside the other keys")
      ->check(program::not_empty())
      ->type_name("FILE");
}

}  // namespace forcebound::client
