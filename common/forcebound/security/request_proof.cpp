#include "forcebound/security/request_proof.hpp"

#include <sodium.h>

#include <string_view>

#include "forcebound/security/internal/raw.hpp"

namespace forcebound::security {
namespace {

constexpr std::string_view kProofContext = "forcebound handshake request ";

SecretKey product_of(const KeyPair& own, const PublicKey& peer) {
  SecretKey product;
  if (::crypto_scalarmult(raw(*product), raw(*own.secret), raw(peer.bytes)) != 0) *product = {};
  return product;
}

}  // namespace

ProofKey::ProofKey(const KeyPair& own, const PublicKey& peer) : ProofKey(*product_of(own, peer), 'o') {}

ProofKey::ProofKey(const SecretKey& shared) : ProofKey(*shared, 's') {}

ProofKey::ProofKey(const KeyBytes& secret, char what) noexcept {
  static_assert(sizeof key_ == crypto_shorthash_siphash24_KEYBYTES);
  ::crypto_generichash_blake2b_state state;
  ::crypto_generichash_blake2b_init(&state, raw(secret), secret.size(), key_.size());
  const auto context = std::as_bytes(std::span(kProofContext));
  ::crypto_generichash_blake2b_update(&state, raw(context), context.size());
  const auto which = static_cast<unsigned char>(what);
  ::crypto_generichash_blake2b_update(&state, &which, 1);
  ::crypto_generichash_blake2b_final(&state, raw(key_), key_.size());
  wipe(&state, sizeof state);
}

Proof ProofKey::of(const RequestDigest& digest) const noexcept {
  static_assert(kProofBytes == crypto_shorthash_siphash24_BYTES);
  Proof proof;
  ::crypto_shorthash_siphash24(raw(proof), raw(digest), digest.size(), raw(key_));
  return proof;
}

bool ProofKey::made(const Proof& proof, const RequestDigest& digest) const noexcept {
  const Proof own = of(digest);
  return ::sodium_memcmp(proof.data(), own.data(), own.size()) == 0;
}

}  // namespace forcebound::security
