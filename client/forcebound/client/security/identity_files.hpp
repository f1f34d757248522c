#pragma once

#include <optional>
#include <string>

#include "forcebound/client/security/handshaker.hpp"

namespace forcebound::client {

/// The files and words by which a user says whom a client believes. All empty: the client does not encrypt.
struct IdentityFiles {
  std::string key{};            ///< file of the client's secret key; empty: a new one for this run
  std::string server_key{};     ///< the server's public key in base64, or its file; empty: as in `known_servers`
  std::string known_servers{};  ///< file of servers and their keys; empty: the user's own, `default_known_servers`
  std::string shared_key{};     ///< file of a key that the server has too; alone: there are no other keys
  bool trust_new = false;       ///< the key of a server that `known_servers` lacks is believed and added to it

  /// Whether anything is given.
  [[nodiscard]] bool any() const noexcept {
    return trust_new || !key.empty() || !server_key.empty() || !known_servers.empty() || !shared_key.empty();
  }
};

/// forcebound/known_servers in the folder of the user's settings (XDG_CONFIG_HOME, or .config in HOME); empty if the
/// environment names none.
[[nodiscard]] std::string default_known_servers();

/// Reads the files; the pattern is nn_psk0 if a shared key is all that is given. For set-up only.
/// @param server HOST:PORT as the user wrote it
/// @param random fills with bytes that nobody can guess, where no key is given
/// @throws config::ConfigError in one line, which never contains a secret; std::invalid_argument for words that exclude
/// each other, or where no file of known servers can be found
[[nodiscard]] Identity read_identity(const IdentityFiles& files, const std::string& server,
                                     const Handshaker::FillRandom& random);

}  // namespace forcebound::client
