#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/security/server_keys.hpp"

namespace forcebound::server {

/// Where a server's keys are, as its command line has them: files, by name; empty: not given.
struct KeyFiles {
  std::string key{};      ///< of the server's secret key
  std::string clients{};  ///< of the clients that are let in
  std::string psk{};      ///< of the key that all share
  bool insecure = false;

  [[nodiscard]] bool any() const noexcept { return !key.empty() || !psk.empty(); }
};

/// @throws std::invalid_argument for a key that would let everybody in, and for a list of clients that is never read
void expect_bounds(const KeyFiles& files);

/// @throws std::invalid_argument, with what would be accepted, if others than this machine could reach the address in
/// the clear and nobody asked for that
void expect_encryption(const KeyFiles& files, const net::Address& address);

/// The keys in the files; nothing: sessions in the clear.
/// @param scenes that the list of clients may name; empty: any
/// @throws config::ConfigError in one line
[[nodiscard]] std::optional<ServerKeys> read_keys(const KeyFiles& files, const std::vector<std::string>& scenes = {});

/// As in RunInfo::encryption.
[[nodiscard]] std::string encryption_name(const std::optional<ServerKeys>& keys);

/// "encrypted: IKpsk2, public key ...", "not encrypted: this machine only"
[[nodiscard]] std::string encryption_in_words(const KeyFiles& files, const std::optional<ServerKeys>& keys);

}  // namespace forcebound::server
