#include "forcebound/security/handshake_datagram.hpp"

#include <sodium.h>

#include <algorithm>

#include "forcebound/security/internal/little_end.hpp"
#include "forcebound/security/internal/raw.hpp"

namespace forcebound::security {
namespace {

constexpr std::array kHandshakeMark{std::byte{'F'}, std::byte{'H'}, std::byte{2}};
constexpr std::size_t kKindAt = 3;
constexpr std::size_t kPatternAt = 4;
constexpr std::size_t kNumberAt = 5;
constexpr std::size_t kZerosAt = 6;
constexpr std::size_t kClientAt = 8;

constexpr std::byte kRequest{1};
constexpr std::byte kOffer{2};
constexpr std::byte kAnswer{3};
constexpr std::byte kIkPsk2{1};
constexpr std::byte kNnPsk0{2};

HandshakePrologue heading(std::byte kind, const HandshakeTopic& topic) noexcept {
  HandshakePrologue bytes{};
  std::ranges::copy(kHandshakeMark, bytes.begin());
  bytes[kKindAt] = kind;
  bytes[kPatternAt] = topic.pattern == Pattern::ik_psk2 ? kIkPsk2 : kNnPsk0;
  bytes[kNumberAt] = std::byte{topic.handshake};
  put_little_end_first(topic.client, std::span(bytes).subspan(kClientAt));
  return bytes;
}

std::optional<HandshakeTopic> topic_of(std::span<const std::byte> datagram) noexcept {
  const std::byte pattern = datagram[kPatternAt];
  if (pattern != kIkPsk2 && pattern != kNnPsk0) return std::nullopt;
  if (datagram[kZerosAt] != std::byte{0} || datagram[kZerosAt + 1] != std::byte{0}) return std::nullopt;
  return HandshakeTopic{.pattern = pattern == kIkPsk2 ? Pattern::ik_psk2 : Pattern::nn_psk0,
                        .handshake = std::to_integer<std::uint8_t>(datagram[kNumberAt]),
                        .client = little_end_first<std::uint32_t>(datagram.subspan(kClientAt))};
}

/// Writes parts one after the other.
class Joined {
 public:
  explicit Joined(std::span<std::byte> out) noexcept : out_(out) {}

  Joined& add(std::span<const std::byte> part) noexcept {
    fits_ = fits_ && part.size() <= out_.size() - used_;
    if (!fits_) return *this;
    std::ranges::copy(part, out_.subspan(used_).begin());
    used_ += part.size();
    return *this;
  }

  [[nodiscard]] std::size_t bytes() const noexcept { return fits_ ? used_ : 0; }

 private:
  std::span<std::byte> out_;
  std::size_t used_ = 0;
  bool fits_ = true;
};

}  // namespace

HandshakePrologue prologue_of(const HandshakeTopic& topic) noexcept { return heading(kRequest, topic); }

std::array<std::byte, kAdmissionBytes> to_bytes(const Admission& admission) noexcept {
  std::array<std::byte, kAdmissionBytes> bytes{};
  bytes[0] = static_cast<std::byte>(admission.verdict);
  put_little_end_first(admission.server, std::span(bytes).subspan(1));
  return bytes;
}

std::optional<Admission> admission_from(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() != kAdmissionBytes || bytes[0] > static_cast<std::byte>(Verdict::full)) return std::nullopt;
  return Admission{.verdict = static_cast<Verdict>(bytes[0]),
                   .server = little_end_first<std::uint32_t>(bytes.subspan(1))};
}

bool is_handshake(std::span<const std::byte> datagram) noexcept {
  return datagram.size() >= kHandshakePrologueBytes &&
         std::equal(kHandshakeMark.begin(), kHandshakeMark.end(), datagram.begin());
}

HandshakeDatagram read_handshake(std::span<const std::byte> datagram) noexcept {
  if (!is_handshake(datagram)) return {};
  const auto topic = topic_of(datagram);
  if (!topic) return {};
  const auto rest = datagram.subspan(kHandshakePrologueBytes);
  const std::byte kind = datagram[kKindAt];
  if (kind == kRequest) {
    const std::size_t bytes = Handshake::overhead(topic->pattern, 0);
    constexpr std::size_t kBefore = kCookieBytes + 2 * kProofBytes;
    if (rest.size() < kBefore + bytes) return {};
    HandshakeRequest request{.topic = *topic, .message = rest.subspan(kBefore, bytes)};
    std::copy_n(rest.begin(), kCookieBytes, request.cookie.begin());
    std::copy_n(rest.begin() + kCookieBytes, kProofBytes, request.proofs.own.begin());
    std::copy_n(rest.begin() + kCookieBytes + kProofBytes, kProofBytes, request.proofs.shared.begin());
    return request;
  }
  if (kind == kOffer) {
    if (rest.size() != kCookieBytes + kKeyBytes) return {};
    CookieOffer offer{.topic = *topic};
    std::copy_n(rest.begin(), kCookieBytes, offer.cookie.begin());
    std::ranges::copy(rest.subspan(kCookieBytes), offer.server.bytes.begin());
    return offer;
  }
  if (kind != kAnswer || rest.size() != Handshake::overhead(topic->pattern, 1) + kAdmissionBytes) return {};
  return HandshakeAnswer{.topic = *topic, .message = rest};
}

RequestDigest digest_of(const HandshakeRequest& request) noexcept {
  RequestDigest digest;
  const HandshakePrologue prologue = prologue_of(request.topic);
  ::crypto_generichash_blake2b_state state;
  ::crypto_generichash_blake2b_init(&state, nullptr, 0, digest.size());
  for (const std::span<const std::byte> part :
       {std::span<const std::byte>(prologue), std::span<const std::byte>(request.cookie), request.message}) {
    ::crypto_generichash_blake2b_update(&state, raw(part), part.size());
  }
  ::crypto_generichash_blake2b_final(&state, raw(digest), digest.size());
  return digest;
}

std::size_t write(const HandshakeRequest& request, std::span<std::byte> out) noexcept {
  return Joined(out)
      .add(heading(kRequest, request.topic))
      .add(request.cookie)
      .add(request.proofs.own)
      .add(request.proofs.shared)
      .add(request.message)
      .bytes();
}

std::size_t write(const CookieOffer& offer, std::span<std::byte> out) noexcept {
  return Joined(out).add(heading(kOffer, offer.topic)).add(offer.cookie).add(offer.server.bytes).bytes();
}

std::size_t write(const HandshakeAnswer& answer, std::span<std::byte> out) noexcept {
  return Joined(out).add(heading(kAnswer, answer.topic)).add(answer.message).bytes();
}

}  // namespace forcebound::security
