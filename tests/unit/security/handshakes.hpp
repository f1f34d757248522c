#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "forcebound/security/keys.hpp"
#include "forcebound/security/noise.hpp"

namespace forcebound::security {

/// Any key, another for each number.
inline KeyBytes key_bytes(std::uint8_t number) {
  KeyBytes key;
  key.fill(std::byte{number});
  key[0] = std::byte{0x5a};
  return key;
}

inline SecretKey secret_key(std::uint8_t number) {
  SecretKey key;
  *key = key_bytes(number);
  return key;
}

inline PublicKey public_key(std::uint8_t number) { return key_pair_from(key_bytes(number)).public_key; }

inline std::string public_text(std::uint8_t number) { return to_base64(public_key(number).bytes); }

/// Keys of both ends and the handshake between them.
struct Ends {
  KeyPair client = key_pair_from(key_bytes(1));
  KeyPair server = key_pair_from(key_bytes(2));
  SecretKey shared = secret_key(3);
  std::array<std::byte, 600> first{};
  std::array<std::byte, 600> second{};
  std::array<std::byte, 600> payload{};

  [[nodiscard]] Handshake client_end() const {
    return Handshake({.pattern = Pattern::ik_psk2,
                      .role = Role::initiator,
                      .own = &client,
                      .peer = &server.public_key,
                      .shared = &shared});
  }
  [[nodiscard]] Handshake server_end() const {
    return Handshake({.pattern = Pattern::ik_psk2, .role = Role::responder, .own = &server, .shared = &shared});
  }

  /// The keys of a whole handshake, of the client and of the server.
  [[nodiscard]] std::array<TransportKeys, 2> keys(std::uint8_t number) {
    Handshake begins = client_end();
    Handshake answers = server_end();
    const auto hello = begins.write({}, first, key_bytes(static_cast<std::uint8_t>(number + 100)));
    EXPECT_EQ(answers.read(std::span(first).first(hello.bytes), payload).result, HandshakeResult::done);
    const auto welcome = answers.write({}, second, key_bytes(static_cast<std::uint8_t>(number + 150)));
    EXPECT_EQ(begins.read(std::span(second).first(welcome.bytes), payload).result, HandshakeResult::done);
    std::array<TransportKeys, 2> both;
    begins.split(both[0]);
    answers.split(both[1]);
    return both;
  }
};

}  // namespace forcebound::security
