#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/security/channel.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/security/noise.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::server {

using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// The client's end of encryption, without a network: what it would send, and what it makes of what it is sent.
class ClientEnd {
 public:
  struct Keys {
    const security::KeyPair* own = nullptr;  ///< null: NNpsk0
    const security::PublicKey* server = nullptr;
    const security::SecretKey* shared = nullptr;
  };

  ClientEnd(const Keys& keys, std::uint32_t number) : keys_(keys) {
    topic_ = {.pattern = keys.own == nullptr ? security::Pattern::nn_psk0 : security::Pattern::ik_psk2,
              .handshake = 1,
              .client = number};
    if (keys.own != nullptr) proof_keys_.own.emplace(*keys.own, *keys.server);
    if (keys.shared != nullptr) proof_keys_.shared.emplace(*keys.shared);
    begin(1);
  }

  /// Another handshake of the session.
  void begin(std::uint8_t handshake) {
    topic_.handshake = handshake;
    const auto prologue = security::prologue_of(topic_);
    noise_.emplace(security::HandshakeSetup{.pattern = topic_.pattern,
                                            .role = security::Role::initiator,
                                            .prologue = prologue,
                                            .own = keys_.own,
                                            .peer = keys_.server,
                                            .shared = keys_.shared});
    message_.resize(security::Handshake::overhead(topic_.pattern, 0));
    ASSERT_EQ(noise_->write({}, message_, ephemeral()).result, security::HandshakeResult::done);
  }

  /// As it goes in the clear. Without a cookie it asks for one.
  [[nodiscard]] Bytes request() const {
    Bytes datagram = later_request();
    datagram.resize(security::kRequestBytes);
    return datagram;
  }

  /// As it goes within a sealed datagram.
  [[nodiscard]] Bytes later_request() const {
    security::HandshakeRequest request{.topic = topic_, .cookie = cookie_, .message = message_};
    request.proofs = proof_keys_.of(security::digest_of(request));
    Bytes datagram(security::kRequestBytes);
    datagram.resize(security::write(request, datagram));
    return datagram;
  }

  /// @return the server's public key in it
  std::optional<security::PublicKey> accept_offer(std::span<const std::byte> datagram) {
    const auto read = security::read_handshake(datagram);
    const auto* const offer = std::get_if<security::CookieOffer>(&read);
    if (offer == nullptr || offer->topic != topic_) return std::nullopt;
    cookie_ = offer->cookie;
    return offer->server;
  }

  void set_cookie(const security::Cookie& cookie) { cookie_ = cookie; }

  /// What the server decided; nothing: it is no answer to the newest handshake.
  std::optional<security::Admission> accept_answer(std::span<const std::byte> datagram, time::Nanoseconds now) {
    const auto read = security::read_handshake(datagram);
    const auto* const answer = std::get_if<security::HandshakeAnswer>(&read);
    if (answer == nullptr || answer->topic != topic_) return std::nullopt;
    std::array<std::byte, security::kAdmissionBytes> payload{};
    if (noise_->read(answer->message, payload).result != security::HandshakeResult::done) return std::nullopt;
    const auto admission = security::admission_from(payload);
    if (!admission || admission->verdict != security::Verdict::let_in) return admission;
    if (topic_.handshake == 1) channel_.begin({.own = topic_.client, .peer = admission->server});
    security::TransportKeys keys;
    noise_->split(keys);
    EXPECT_TRUE(channel_.install(topic_.handshake, keys, security::Role::initiator, now));
    return admission;
  }

  [[nodiscard]] Bytes seal(std::span<const std::byte> content, time::Nanoseconds now) {
    Bytes record(content.size() + security::kRecordOverhead);
    const auto bytes = channel_.seal(content, record, now);
    EXPECT_TRUE(bytes.has_value());
    record.resize(bytes.value_or(0));
    return record;
  }
  [[nodiscard]] Bytes seal(std::string_view text, time::Nanoseconds now) { return seal(bytes_of(text), now); }

  /// Nothing if it cannot be opened.
  [[nodiscard]] std::optional<Bytes> open(std::span<const std::byte> record, time::Nanoseconds now) {
    Bytes plain(net::kDatagramBytesMax);
    const auto opened = channel_.open(record, plain, now);
    if (opened.result != security::Opening::opened) return std::nullopt;
    plain.resize(opened.bytes);
    return plain;
  }

 private:
  /// Another one each time; nobody needs to be unable to guess it here.
  static security::KeyBytes ephemeral() {
    static std::uint32_t count = 0;
    security::KeyBytes key = security::key_bytes(0x77);
    ++count;
    for (std::size_t i = 0; i < sizeof count; ++i) key[8 + i] = static_cast<std::byte>(count >> 8 * i & 0xffU);
    return key;
  }

  Keys keys_;
  security::ProofKeys proof_keys_;
  security::HandshakeTopic topic_;
  security::Cookie cookie_{};
  std::optional<security::Handshake> noise_;
  Bytes message_;
  security::Channel channel_{security::SessionNumbers{}};
};

}  // namespace forcebound::server
