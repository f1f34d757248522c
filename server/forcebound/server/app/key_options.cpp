#include "forcebound/server/app/key_options.hpp"

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "forcebound/program/command_line.hpp"
#include "forcebound/security/key_file.hpp"

namespace forcebound::server {

void add_key_options(CLI::App& app, KeyOptions& keys) {
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

void expect_bounds(const KeyOptions& keys) {
  if (keys.key.empty() || !keys.clients.empty() || !keys.psk.empty()) return;
  throw std::invalid_argument(
      "--key: alone it would let anybody in, since clients know the server's public key; accepted is --key with "
      "--clients (who is let in), with --psk (a key that they share), or with both");
}

void expect_encryption(const KeyOptions& keys, const net::Address& address) {
  if (keys.any() || keys.insecure || net::is_loopback(address)) return;
  throw std::invalid_argument(
      "--listen: other machines can reach " + net::to_string(address) +
      ", so sessions must be encrypted; accepted are --key with --clients, or --psk (forcebound keygen makes the "
      "keys), or --insecure for a network in which everybody is trusted");
}

std::optional<ServerKeys> read_keys(const KeyOptions& keys, const std::vector<std::string>& scenes) {
  if (!keys.any()) return std::nullopt;
  ServerKeys read;
  if (!keys.key.empty()) read.own = security::read_key_pair(keys.key);
  if (!keys.clients.empty()) read.clients = security::AllowedClients::from_file(keys.clients, scenes);
  if (!keys.psk.empty()) read.shared = security::read_shared_key(keys.psk);
  return read;
}

std::string encryption_in_words(const KeyOptions& keys, const std::optional<ServerKeys>& read) {
  if (!read) return keys.insecure ? "NOT ENCRYPTED (--insecure)" : "not encrypted: this machine only";
  std::string words = "encrypted: " + encryption_name(read);
  if (read->own) words += ", public key " + security::to_base64(read->own->public_key.bytes);
  return words;
}

std::string encryption_name(const std::optional<ServerKeys>& keys) {
  return keys ? std::string(security::name_of(keys->pattern())) : "none";
}

}  // namespace forcebound::server
