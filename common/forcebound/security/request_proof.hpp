#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "forcebound/security/keys.hpp"

namespace forcebound::security {

/// Shows a server that a handshake request was made now, for it, by one of those whom it lets in, at the cost of a hash
/// where reading the handshake's message costs products on the curve. It is of the request's cookie, which the server
/// has just made for the address: who records a request can do nothing with it at another address, later, or at another
/// server that has the same key.
///
/// SipHash-2-4 (Aumasson and Bernstein 2012) of a digest of the request; what it keeps away is work alone. Who somebody
/// is, only the handshake shows.
inline constexpr std::size_t kProofBytes = 8;
using Proof = std::array<std::byte, kProofBytes>;

/// Zero where there is no such key.
struct Proofs {
  Proof own{};     ///< by the secret that the client's key pair and the server's have in common
  Proof shared{};  ///< by the shared key
};

/// What of a request is proven: BLAKE2b (RFC 7693) of its prologue, cookie and message.
using RequestDigest = std::array<std::byte, 16>;

/// A key of proofs. Nothing follows from it but that key: no other key, and nothing that was sealed.
class ProofKey {
 public:
  /// The same at both ends, for a product on the curve. Of a peer's key of low order it is one that all know.
  ProofKey(const KeyPair& own, const PublicKey& peer);
  explicit ProofKey(const SecretKey& shared);

  [[nodiscard]] Proof of(const RequestDigest& digest) const noexcept;

  /// In a time that does not depend on the proof. Below 0.1 us.
  [[nodiscard]] bool made(const Proof& proof, const RequestDigest& digest) const noexcept;

 private:
  explicit ProofKey(const KeyBytes& secret, char what) noexcept;
  std::array<std::byte, 16> key_{};
};

/// A client's keys of proofs, of which each end uses what both have.
struct ProofKeys {
  std::optional<ProofKey> own{};
  std::optional<ProofKey> shared{};

  [[nodiscard]] Proofs of(const RequestDigest& digest) const noexcept {
    return {.own = own ? own->of(digest) : Proof{}, .shared = shared ? shared->of(digest) : Proof{}};
  }
};

}  // namespace forcebound::security
