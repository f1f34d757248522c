#pragma once

#include <string>
#include <string_view>

#include "forcebound/security/keys.hpp"

namespace forcebound::security {

// Files with one key in one line of text: what it is, then the key in base64. Lines that begin with '#', and empty
// ones, are comments.
//
//     forcebound-secret-key pL2z...   an end's own; the public key follows from it
//     forcebound-shared-key 8cQx...   known to both ends
//     forcebound-public-key Zm9y...   given to others
//
// A secret or shared key is refused if anybody but the file's owner may read or change it, or if the owner is neither
// this user nor root. Root may let one group read it that this process is in, as Kubernetes does with fsGroup. For
// set-up only. All @throw config::ConfigError in one line, which never contains a key.

/// The key pair of a secret key's file.
[[nodiscard]] KeyPair read_key_pair(const std::string& path);

[[nodiscard]] SecretKey read_shared_key(const std::string& path);

/// The key itself in base64, or the file that has it.
[[nodiscard]] PublicKey read_public_key(const std::string& key_or_path);

/// New files, for their owner alone (mode 0600). One that is there is never replaced: the key in it would be lost.
void write_secret_key(const std::string& path, const SecretKey& key);
void write_shared_key(const std::string& path, const SecretKey& key);

}  // namespace forcebound::security
