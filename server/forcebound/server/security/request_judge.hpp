#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/security/allowed_clients.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/security/request_proof.hpp"
#include "forcebound/server/security/server_keys.hpp"

namespace forcebound::server {

/// Tells by a request's proofs, before any product on the curve, whether one of those whom the server lets in has made
/// it now: of a list, whose key it is; of a shared key alone, no more than that.
///
/// Real time: `judge` is noexcept and allocates nothing; about 1 us, and 30 ns for each client of the list. Not
/// thread-safe.
class RequestJudge {
 public:
  explicit RequestJudge(const ServerKeys& keys);

  /// The list has changed. A product on the curve for each key that is new in it.
  void replace(const ServerKeys& keys);

  /// @return who is to be charged for it: a number of the client's key, or without a list of the source; nothing: it is
  /// not proven
  [[nodiscard]] std::optional<std::uint64_t> judge(const security::HandshakeRequest& request,
                                                   const net::Address& from) const noexcept;

  /// Whether it is proven by the shared key, or there is none.
  [[nodiscard]] bool knows_shared(const security::HandshakeRequest& request) const noexcept;

  /// What a judgement costs at most, in hashes.
  [[nodiscard]] std::size_t hashes() const noexcept;

  /// The number of a client's key: its first bytes, which are another's by no chance that matters.
  [[nodiscard]] static std::uint64_t number_of(const security::PublicKey& key) noexcept;

 private:
  struct Listed {
    security::PublicKey key;
    security::ProofKey proves;
  };
  bool has_list_ = false;
  std::vector<Listed> listed_;
  std::optional<security::ProofKey> shared_;
};

}  // namespace forcebound::server
