#pragma once

#include <optional>
#include <string>

#include "forcebound/server/security/key_files.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace forcebound::server {

/// The options --key, --clients, --psk and --insecure.
void add_key_options(CLI::App& app, KeyFiles& keys);

/// "encrypted: IKpsk2, public key ...", "not encrypted: this machine only"
[[nodiscard]] std::string encryption_in_words(const KeyFiles& keys, const std::optional<ServerKeys>& read);

}  // namespace forcebound::server
