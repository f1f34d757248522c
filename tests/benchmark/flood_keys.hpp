#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/security/channel.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/security/key_file.hpp"
#include "forcebound/security/keys.hpp"
#include "forcebound/security/noise.hpp"

namespace forcebound {

/// A handshake that a client's key has begun: its request, and what becomes of the answer.
class BegunHandshake {
 public:
  /// @param proves of these two; must outlive it
  BegunHandshake(const security::KeyPair& own, const security::PublicKey& server, const security::ProofKey& proves,
                 std::mt19937_64& random)
      : topic_{.client = static_cast<std::uint32_t>(random() | 1U)}, proves_(proves) {
    const security::HandshakePrologue prologue = security::prologue_of(topic_);
    noise_.emplace(security::HandshakeSetup{
        .role = security::Role::initiator, .prologue = prologue, .own = &own, .peer = &server});
    security::KeyBytes ephemeral;
    std::ranges::generate(ephemeral, [&] { return static_cast<std::byte>(random()); });
    message_.resize(security::Handshake::overhead(topic_.pattern, 0));
    (void)noise_->write({}, message_, ephemeral);
  }

  /// What is begun for its request alone keeps no keys: a system allows only so many pieces of locked memory.
  void expect_no_answer() {
    noise_.reset();
    channel_.reset();
  }

  /// Whether it gave a session of keys.
  bool accept_answer(const security::HandshakeAnswer& answer, time::Nanoseconds now) {
    std::array<std::byte, security::kAdmissionBytes> payload{};
    if (answer.topic != topic_ || noise_->read(answer.message, payload).result != security::HandshakeResult::done) {
      return false;
    }
    const auto admission = security::admission_from(payload);
    if (!admission || admission->verdict != security::Verdict::let_in) return false;
    channel_->begin({.own = topic_.client, .peer = admission->server});
    security::TransportKeys keys;
    noise_->split(keys);
    return channel_->install(topic_.handshake, keys, security::Role::initiator, now);
  }

  /// Valid until the next call.
  [[nodiscard]] std::span<const std::byte> seal(std::span<const std::byte> content, time::Nanoseconds now) {
    return std::span(record_).first(channel_->seal(content, record_, now).value_or(0));
  }

  /// The content; empty if it cannot be opened. Valid until the next call.
  [[nodiscard]] std::span<const std::byte> open(std::span<const std::byte> record, time::Nanoseconds now) {
    return std::span(plain_).first(channel_->open(record, plain_, now).bytes);
  }

  /// To `datagram`, of security::kRequestBytes.
  void write_request(const security::Cookie& cookie, std::span<std::byte> datagram) const {
    write_request(cookie, cookie, datagram);
  }

  /// As another recorded it who had a cookie of then, and now has another.
  void write_recorded(const security::Cookie& now, std::span<std::byte> datagram) const {
    write_request(security::Cookie{std::byte{1}}, now, datagram);
  }

 private:
  void write_request(const security::Cookie& proven, const security::Cookie& cookie,
                     std::span<std::byte> datagram) const {
    security::HandshakeRequest request{.topic = topic_, .cookie = proven, .message = message_};
    request.proofs.own = proves_.of(security::digest_of(request));
    request.cookie = cookie;
    security::write(request, datagram);
  }

  security::HandshakeTopic topic_;
  const security::ProofKey& proves_;
  std::optional<security::Handshake> noise_;
  std::vector<std::byte> message_;
  std::optional<security::Channel> channel_{security::SessionNumbers{}};
  std::array<std::byte, net::kDatagramBytesMax> record_{};
  std::array<std::byte, net::kDatagramBytesMax> plain_{};
};

/// Handshakes begun by the clients of these keys, in turn.
class KeyHolders {
 public:
  KeyHolders(const std::string& server, std::span<const std::string> keys)
      : server_(security::read_public_key(server)) {
    proofs_.reserve(keys.size());
    for (const std::string& key : keys) {
      keys_.push_back(security::read_key_pair(key));
      proofs_.emplace_back(keys_.back(), server_);
    }
  }

  enum class Until : std::uint8_t { request, session };
  void begin(std::size_t count, Until until, std::mt19937_64& random) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t whose = i % keys_.size();
      begun_.push_back(std::make_unique<BegunHandshake>(keys_[whose], server_, proofs_[whose], random));
      if (until == Until::request) begun_.back()->expect_no_answer();
    }
  }

  [[nodiscard]] std::size_t count() const noexcept { return begun_.size(); }
  [[nodiscard]] BegunHandshake& operator[](std::size_t i) { return *begun_[i % begun_.size()]; }

 private:
  security::PublicKey server_;
  std::vector<security::KeyPair> keys_;
  std::vector<security::ProofKey> proofs_;
  std::vector<std::unique_ptr<BegunHandshake>> begun_;
};

}  // namespace forcebound
