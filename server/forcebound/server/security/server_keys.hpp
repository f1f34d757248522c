#pragma once

#include <optional>

#include "forcebound/security/allowed_clients.hpp"
#include "forcebound/security/keys.hpp"
#include "forcebound/security/noise.hpp"

namespace forcebound::server {

/// How a server shows who it is, and whom it lets in. There must be `own` or `shared`.
struct ServerKeys {
  std::optional<security::KeyPair> own{};             ///< there: IKpsk2, otherwise NNpsk0
  std::optional<security::AllowedClients> clients{};  ///< of IKpsk2; nothing: whoever has the shared key
  std::optional<security::SecretKey> shared{};

  /// For another worker.
  [[nodiscard]] ServerKeys copy() const {
    ServerKeys copied;
    if (own) {
      copied.own.emplace();
      *copied.own->secret = *own->secret;
      copied.own->public_key = own->public_key;
    }
    copied.clients = clients;
    if (shared) **(copied.shared = security::SecretKey()) = **shared;
    return copied;
  }

  [[nodiscard]] security::Pattern pattern() const noexcept {
    return own ? security::Pattern::ik_psk2 : security::Pattern::nn_psk0;
  }
};

}  // namespace forcebound::server
