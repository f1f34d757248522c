#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/security/server_keys.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace forcebound::server {

/// The command line's options on encryption: files, by name; empty: not given.
struct KeyOptions {
  std::string key{};      ///< of the server's secret key
  std::string clients{};  ///< of the clients that are let in
  std::string psk{};      ///< of the key that all share
  bool insecure = false;

  [[nodiscard]] bool any() const noexcept { return !key.empty() || !psk.empty(); }
};

void add_key_options(CLI::App& app, KeyOptions& keys);

/// @throws std::invalid_argument for a key that would let everybody in
void expect_bounds(const KeyOptions& keys);

/// @throws std::invalid_argument, with what would be accepted, if others than this machine could reach the address in
/// the clear and nobody asked for that
void expect_encryption(const KeyOptions& keys, const net::Address& address);

/// The keys in the files; nothing: sessions in the clear.
/// @param scenes that the list of clients may name; empty: any
/// @throws config::ConfigError in one line
[[nodiscard]] std::optional<ServerKeys> read_keys(const KeyOptions& keys, const std::vector<std::string>& scenes = {});

/// "encrypted: IKpsk2, public key ...", "not encrypted: this machine only"
[[nodiscard]] std::string encryption_in_words(const KeyOptions& keys, const std::optional<ServerKeys>& read);

/// As in RunInfo::encryption.
[[nodiscard]] std::string encryption_name(const std::optional<ServerKeys>& keys);

}  // namespace forcebound::server
