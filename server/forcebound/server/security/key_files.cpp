#include "forcebound/server/security/key_files.hpp"

#include <stdexcept>

#include "forcebound/security/key_file.hpp"

namespace forcebound::server {

void expect_bounds(const KeyFiles& files) {
  if (!files.clients.empty() && files.key.empty())
    throw std::invalid_argument("--clients: they are let in by their keys, so it needs --key, of this server");
  if (files.key.empty() || !files.clients.empty() || !files.psk.empty()) return;
  throw std::invalid_argument(
      "--key: alone it would let anybody in, since clients know the server's public key; accepted is --key with "
      "--clients (who is let in), with --psk (a key that they share), or with both");
}

void expect_encryption(const KeyFiles& files, const net::Address& address) {
  if (files.any() || files.insecure || net::is_loopback(address)) return;
  throw std::invalid_argument(
      "--listen: other machines can reach " + net::to_string(address) +
      ", so sessions must be encrypted; accepted are --key with --clients, or --psk (forcebound keygen makes the "
      "keys), or --insecure for a network in which everybody is trusted");
}

std::optional<ServerKeys> read_keys(const KeyFiles& files, const std::vector<std::string>& scenes) {
  if (!files.any()) return std::nullopt;
  ServerKeys read;
  if (!files.key.empty()) read.own = security::read_key_pair(files.key);
  if (!files.clients.empty()) read.clients = security::AllowedClients::from_file(files.clients, scenes);
  if (!files.psk.empty()) read.shared = security::read_shared_key(files.psk);
  return read;
}

std::string encryption_name(const std::optional<ServerKeys>& keys) {
  return keys ? std::string(security::name_of(keys->pattern())) : "none";
}

std::string encryption_in_words(const KeyFiles& files, const std::optional<ServerKeys>& keys) {
  if (!keys) return files.insecure ? "NOT ENCRYPTED (--insecure)" : "not encrypted: this machine only";
  std::string words = "encrypted: " + encryption_name(keys);
  if (keys->own) words += ", public key " + security::to_base64(keys->own->public_key.bytes);
  return words;
}

}  // namespace forcebound::server
