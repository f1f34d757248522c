#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "forcebound/security/cookies.hpp"
#include "forcebound/security/keys.hpp"
#include "forcebound/security/noise.hpp"
#include "forcebound/security/request_proof.hpp"

namespace forcebound::security {

// How a session gets its keys. All datagrams begin with the same 12 bytes; numbers are little end first:
//
//     0   2  mark 'F' 'H'
//     2   1  version, 2
//     3   1  kind: 1 request, 2 cookie, 3 answer
//     4   1  pattern: 1 IKpsk2, 2 NNpsk0
//     5   1  number of the handshake
//     6   2  zero
//     8   4  the client's number for the session
//
//     client                                                  server
//     request without cookie, padded to 1200 bytes      ->
//                                                       <-    cookie, and the server's public key: no state, no memory
//     request with the cookie, proofs (request_proof.hpp)
//     and Noise's first message                         ->
//                                                       <-    answer: Noise's second message
//     sealed datagrams (channel.hpp), the first of which is a Hello, both ways
//
// A later handshake of the same session travels as the content of sealed datagrams, without cookie, proofs and padding.
//
// The first twelve bytes of the request are the handshake's prologue: who changes them on the way changes the keys at
// one end. A cookie datagram is not authentic: the key in it is believed only after a handshake with it, and where a
// user wants so.

/// Length of a request outside of sealed datagrams: no answer is longer.
inline constexpr std::size_t kRequestBytes = 1200;

inline constexpr std::size_t kHandshakePrologueBytes = 12;
using HandshakePrologue = std::array<std::byte, kHandshakePrologueBytes>;

/// What a handshake is about; both ends must agree.
struct HandshakeTopic {
  Pattern pattern = Pattern::ik_psk2;
  std::uint8_t handshake = 1;  ///< its number, modulo 256; the first is 1
  std::uint32_t client = 0;    ///< the client's number for the session
  bool operator==(const HandshakeTopic&) const = default;
};

/// The prologue of the Noise handshake.
[[nodiscard]] HandshakePrologue prologue_of(const HandshakeTopic& topic) noexcept;

/// Client to server.
struct HandshakeRequest {
  HandshakeTopic topic;
  Cookie cookie{};  ///< zero: one is asked for
  Proofs proofs{};  ///< of a first handshake, with the cookie
  /// Noise's first message, without payload; zeros where a cookie is asked for. Of a request that was read, it points
  /// into the datagram.
  std::span<const std::byte> message;
};

/// What its proofs are of: all of it but they.
[[nodiscard]] RequestDigest digest_of(const HandshakeRequest& request) noexcept;

/// Server to client.
struct CookieOffer {
  HandshakeTopic topic;
  Cookie cookie{};
  PublicKey server{};  ///< zero for nn_psk0
};

/// Server to client. The message's payload is an Admission.
struct HandshakeAnswer {
  HandshakeTopic topic;
  std::span<const std::byte> message;  ///< Noise's second; of an answer that was read, it points into the datagram
};

/// What a server decided about who asked.
enum class Verdict : std::uint8_t {
  let_in = 0,
  not_allowed = 1,  ///< the client's public key is not in the server's list
  full = 2,         ///< no room for one more
};

/// The payload of the answer's message: the verdict, and the server's number for the session (0 if not let in).
struct Admission {
  Verdict verdict = Verdict::let_in;
  std::uint32_t server = 0;
  bool operator==(const Admission&) const = default;
};
inline constexpr std::size_t kAdmissionBytes = 5;
[[nodiscard]] std::array<std::byte, kAdmissionBytes> to_bytes(const Admission& admission) noexcept;
/// Nothing for what is not five bytes with a known verdict.
[[nodiscard]] std::optional<Admission> admission_from(std::span<const std::byte> bytes) noexcept;

/// Length of a cookie datagram, and of the longest answer.
inline constexpr std::size_t kCookieOfferBytes = kHandshakePrologueBytes + kCookieBytes + kKeyBytes;
inline constexpr std::size_t kAnswerBytesMost = 128;
/// Of a request within a sealed datagram.
inline constexpr std::size_t kSealedRequestBytesMost = 160;

/// Whether this is one of these datagrams rather than a sealed one or one in the clear. Anybody can send one.
[[nodiscard]] bool is_handshake(std::span<const std::byte> datagram) noexcept;

using HandshakeDatagram = std::variant<std::monostate, HandshakeRequest, CookieOffer, HandshakeAnswer>;

/// What `is_handshake` says is one; monostate if it is malformed. A request of any length is read if its message is
/// whole; whether it was padded must be asked of the datagram. `datagram` is untrusted. noexcept, no allocation.
[[nodiscard]] HandshakeDatagram read_handshake(std::span<const std::byte> datagram) noexcept;

/// Writes the datagram to `out`, without padding. @return its length; 0: `out` is too small
std::size_t write(const HandshakeRequest& request, std::span<std::byte> out) noexcept;
std::size_t write(const CookieOffer& offer, std::span<std::byte> out) noexcept;
std::size_t write(const HandshakeAnswer& answer, std::span<std::byte> out) noexcept;

}  // namespace forcebound::security
