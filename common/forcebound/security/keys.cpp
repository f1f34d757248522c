#include "forcebound/security/keys.hpp"

#include <sodium.h>

#include <algorithm>

#include "forcebound/security/base64.hpp"
#include "forcebound/security/internal/raw.hpp"

namespace forcebound::security {
namespace {

constexpr int kBase64 = sodium_base64_VARIANT_ORIGINAL;
constexpr std::size_t kBase64Characters = sodium_base64_ENCODED_LEN(kKeyBytes, kBase64) - 1;

}  // namespace

KeyPair key_pair_from(const KeyBytes& random) {
  KeyPair pair;
  *pair.secret = random;
  ::crypto_scalarmult_base(raw(pair.public_key.bytes), raw(*pair.secret));
  return pair;
}

std::string to_base64(const KeyBytes& key) { return base64_of(key); }

bool from_base64(std::string_view text, KeyBytes& key) noexcept {
  // libsodium 1.0.18 takes some bytes beyond ASCII for characters of base64.
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80U; };
  key = {};
  std::size_t bytes = 0;
  const char* end = nullptr;
  if (text.size() == kBase64Characters && std::ranges::all_of(text, is_ascii) &&
      ::sodium_base642bin(raw(key), key.size(), text.data(), text.size(), nullptr, &bytes, &end, kBase64) == 0 &&
      bytes == key.size() && end == text.data() + text.size()) {
    return true;
  }
  wipe(key.data(), key.size());
  return false;
}

std::optional<PublicKey> public_key_from(std::string_view text) {
  if (text.starts_with(kPublicKeyWord) && text.substr(kPublicKeyWord.size()).starts_with(' ')) {
    text.remove_prefix(kPublicKeyWord.size() + 1);
  }
  PublicKey key;
  if (!from_base64(text, key.bytes)) return std::nullopt;
  // Any scalar shows whether the point is of low order, since all are multiples of eight.
  const KeyBytes any_scalar{std::byte{1}};
  KeyBytes product{};
  if (::crypto_scalarmult(raw(product), raw(any_scalar), raw(key.bytes)) != 0) return std::nullopt;
  return key;
}

}  // namespace forcebound::security
