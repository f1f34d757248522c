#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "forcebound/security/channel.hpp"
#include "forcebound/security/cookies.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/security/noise.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::client {

using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(std::span<const std::byte> span) { return {span.begin(), span.end()}; }

/// A server as far as a client's handshakes need one: what it is asked, and what it answers if the test wants so.
struct ServerEnd {
  security::Pattern pattern = security::Pattern::ik_psk2;
  security::KeyPair own = security::key_pair_from(security::key_bytes(2));
  security::SecretKey shared = security::secret_key(3);
  security::Cookie cookie{std::byte{7}};
  security::Verdict verdict = security::Verdict::let_in;
  std::uint32_t number = 22;
  std::optional<security::Channel> channel{};
  std::uint8_t random = 60;

  [[nodiscard]] static security::HandshakeRequest request_in(std::span<const std::byte> datagram) {
    const auto read = security::read_handshake(datagram);
    EXPECT_TRUE(std::holds_alternative<security::HandshakeRequest>(read));
    return std::get<security::HandshakeRequest>(read);
  }

  [[nodiscard]] Bytes offer_for(const security::HandshakeRequest& request) const {
    Bytes offer(security::kCookieOfferBytes);
    auto topic = request.topic;
    topic.pattern = pattern;
    const bool has_pair = pattern == security::Pattern::ik_psk2;
    EXPECT_EQ(security::write(
                  security::CookieOffer{
                      .topic = topic, .cookie = cookie, .server = has_pair ? own.public_key : security::PublicKey{}},
                  offer),
              offer.size());
    return offer;
  }

  /// The answer to Noise's first message; empty: it is not authentic. Keys of a first handshake begin a channel.
  [[nodiscard]] Bytes answer_to(const security::HandshakeRequest& request, time::Nanoseconds now) {
    const auto prologue = security::prologue_of(request.topic);
    security::Handshake handshake(
        {.pattern = pattern, .role = security::Role::responder, .prologue = prologue, .own = &own, .shared = &shared});
    Bytes nothing(64);
    if (handshake.read(request.message, nothing).result != security::HandshakeResult::done) return {};
    Bytes message(security::kAnswerBytesMost);
    const auto admission = security::to_bytes({.verdict = verdict, .server = number});
    const auto written = handshake.write(admission, message, security::key_bytes(++random));
    message.resize(written.bytes);
    Bytes answer(security::kAnswerBytesMost);
    answer.resize(security::write(security::HandshakeAnswer{.topic = request.topic, .message = message}, answer));
    security::TransportKeys keys;
    handshake.split(keys);
    if (request.topic.handshake == 1) {
      channel.emplace(security::SessionNumbers{.own = number, .peer = request.topic.client});
    }
    EXPECT_TRUE(channel->install(request.topic.handshake, keys, security::Role::responder, now));
    return answer;
  }

  [[nodiscard]] Bytes sealed(std::span<const std::byte> content, time::Nanoseconds now) {
    Bytes record(content.size() + security::kRecordOverhead);
    EXPECT_EQ(channel->seal(content, record, now), record.size());
    return record;
  }

  /// The content; empty if it cannot be opened.
  [[nodiscard]] Bytes opened(std::span<const std::byte> record, time::Nanoseconds now) {
    Bytes content(record.size());
    const auto result = channel->open(record, content, now);
    content.resize(result.bytes);
    return content;
  }
};

}  // namespace forcebound::client
