#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/security/locked.hpp"

namespace forcebound::security {

inline constexpr std::size_t kKeyBytes = 32;
using KeyBytes = std::array<std::byte, kKeyBytes>;

/// Half of a key pair that may be known to all (X25519, RFC 7748).
struct PublicKey {
  KeyBytes bytes{};
  bool operator==(const PublicKey&) const = default;
};

/// A secret key, or a key that both ends share.
using SecretKey = Locked<KeyBytes>;

struct KeyPair {
  SecretKey secret;
  PublicKey public_key;
};

/// @param random 32 bytes that nobody can guess; they become the secret key
[[nodiscard]] KeyPair key_pair_from(const KeyBytes& random);

/// 44 characters, as in key files. Of a secret key, wipe the text afterwards.
[[nodiscard]] std::string to_base64(const KeyBytes& key);

/// Reads exactly what `to_base64` writes; nothing if the text is anything else.
/// @return whether `key` was set; if not, it is zero
[[nodiscard]] bool from_base64(std::string_view text, KeyBytes& key) noexcept;

/// The first word of a line or file that has a public key.
inline constexpr std::string_view kPublicKeyWord = "forcebound-public-key";

/// A public key as people hand it over: what `to_base64` writes, alone or after `kPublicKeyWord` and a blank, as
/// `keygen --public` prints it. Only what can be the key of anybody: low-order points give a secret that all know
/// (RFC 7748, section 6.1).
[[nodiscard]] std::optional<PublicKey> public_key_from(std::string_view text);

}  // namespace forcebound::security
