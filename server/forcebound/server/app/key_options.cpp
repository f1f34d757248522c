#include "forcebound/server/app/key_options.hpp"

#include <CLI/CLI.hpp>

#include "forcebound/program/command_line.hpp"

namespace forcebound::server {

void add_key_options(CLI::App& app, KeyFiles& keys) {
  CLI::Option* const key =
      app.add_option("--key", keys.key,
                     "encrypt; file of this server's secret key, as forcebound keygen writes it; with --clients, "
                     "--psk or both")
          ->check(program::not_empty())
          ->type_name("FILE");
  CLI::Option* const clients =
      app.add_option("--clients", keys.clients,
                     "file of the clients that are let in: for each a name, a public key, and where wanted scenes, a "
                     "rate and a most of sessions")
          ->check(program::not_empty())
          ->type_name("FILE.toml")
          ->needs(key);
  CLI::Option* const psk =
      app.add_option("--psk", keys.psk,
                     "encrypt; file of a key that all clients have too, from forcebound keygen --shared; alone, or "
                     "beside --key")
          ->check(program::not_empty())
          ->type_name("FILE");
  app.add_flag("--insecure", keys.insecure,
               "serve other machines without encryption: everybody on the way can read and change all")
      ->excludes(key)
      ->excludes(clients)
      ->excludes(psk);
}

}  // namespace forcebound::server
