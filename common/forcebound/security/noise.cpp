#include "forcebound/security/noise.hpp"

#include <sodium.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "forcebound/security/internal/nonce.hpp"
#include "forcebound/security/internal/raw.hpp"

namespace forcebound::security {
namespace {

constexpr std::size_t kHashBytes = kHandshakeHashBytes;
constexpr std::size_t kHashBlockBytes = 128;
using Hash = std::array<std::byte, kHashBytes>;

enum class Token : std::uint8_t { e, s, ee, es, se, ss, psk };

constexpr std::array kFirstOfIk{Token::e, Token::es, Token::s, Token::ss};
constexpr std::array kSecondOfIk{Token::e, Token::ee, Token::se, Token::psk};
constexpr std::array kFirstOfNn{Token::psk, Token::e};
constexpr std::array kSecondOfNn{Token::e, Token::ee};

std::span<const Token> tokens_of(Pattern pattern, int message) noexcept {
  if (pattern == Pattern::ik_psk2) {
    return message == 0 ? std::span<const Token>(kFirstOfIk) : std::span<const Token>(kSecondOfIk);
  }
  return message == 0 ? std::span<const Token>(kFirstOfNn) : std::span<const Token>(kSecondOfNn);
}

std::string_view protocol_of(Pattern pattern) noexcept {
  return pattern == Pattern::ik_psk2 ? "Noise_IKpsk2_25519_ChaChaPoly_BLAKE2b"
                                     : "Noise_NNpsk0_25519_ChaChaPoly_BLAKE2b";
}

using Parts = std::span<const std::span<const std::byte>>;

void hash_parts(Hash& out, Parts parts) noexcept {
  ::crypto_generichash_blake2b_state state;
  ::crypto_generichash_blake2b_init(&state, nullptr, 0, kHashBytes);
  for (const auto part : parts) ::crypto_generichash_blake2b_update(&state, raw(part), part.size());
  ::crypto_generichash_blake2b_final(&state, raw(out), kHashBytes);
  wipe(&state, sizeof state);
}

/// HMAC (RFC 2104) by unkeyed BLAKE2b, as Noise has it; the keyed mode of BLAKE2b is something else.
void authenticate(Hash& out, const Hash& key, std::span<const std::byte> first,
                  std::span<const std::byte> second) noexcept {
  constexpr std::byte kInner{0x36};
  constexpr std::byte kOuter{0x5c};
  std::array<std::byte, kHashBlockBytes> pad{};
  const auto fill = [&](std::byte with) {
    pad.fill(with);
    for (std::size_t i = 0; i < key.size(); ++i) pad[i] ^= key[i];
  };
  Hash inner{};
  fill(kInner);
  hash_parts(inner, std::array<std::span<const std::byte>, 3>{pad, first, second});
  fill(kOuter);
  hash_parts(out, std::array<std::span<const std::byte>, 2>{pad, inner});
  wipe(pad.data(), pad.size());
  wipe(inner.data(), inner.size());
}

/// Up to three outputs (section 4.3).
struct Derived {
  std::array<Hash, 3> out{};
  Derived(const Hash& chaining_key, std::span<const std::byte> input) noexcept {
    Hash secret{};
    authenticate(secret, chaining_key, input, {});
    std::span<const std::byte> before;
    std::byte number{0};
    for (Hash& next : out) {
      number = std::byte{static_cast<std::uint8_t>(std::to_integer<int>(number) + 1)};
      authenticate(next, secret, before, {&number, 1});
      before = next;
    }
    wipe(secret.data(), secret.size());
  }
  ~Derived() { wipe(out.data(), sizeof out); }
  Derived(const Derived&) = delete;
  Derived& operator=(const Derived&) = delete;
};

/// Into its place, so that no copy stays behind.
void copy_key(KeyBytes& key, const Hash& hash) noexcept { std::copy_n(hash.begin(), key.size(), key.begin()); }

/// Reads or writes a message from its beginning.
template <class Byte>
std::span<Byte> take(std::span<Byte>& from, std::size_t bytes) noexcept {
  const auto taken = from.first(bytes);
  from = from.subspan(bytes);
  return taken;
}

}  // namespace

std::string_view name_of(Pattern pattern) noexcept { return pattern == Pattern::ik_psk2 ? "IKpsk2" : "NNpsk0"; }

/// CipherState, SymmetricState and HandshakeState of section 5.
struct Handshake::State {
  Pattern pattern = Pattern::ik_psk2;
  Role role = Role::initiator;
  int messages = 0;
  Hash chaining_key{};
  Hash hash{};
  KeyBytes key{};
  std::uint64_t nonce = 0;
  bool has_key = false;
  KeyBytes own_secret{};
  PublicKey own{};
  KeyBytes own_ephemeral_secret{};
  PublicKey own_ephemeral{};
  PublicKey peer{};
  PublicKey peer_ephemeral{};
  KeyBytes shared{};

  [[nodiscard]] bool writes_now() const noexcept {
    return messages < 2 && (messages == 0) == (role == Role::initiator);
  }
  [[nodiscard]] bool reads_now() const noexcept { return messages < 2 && !writes_now(); }

  void mix_hash(std::span<const std::byte> data) noexcept {
    Hash mixed{};
    hash_parts(mixed, std::array<std::span<const std::byte>, 2>{hash, data});
    hash = mixed;
  }

  void set_key(const Hash& from) noexcept {
    copy_key(key, from);
    nonce = 0;
    has_key = true;
  }

  void mix_key(std::span<const std::byte> input) noexcept {
    const Derived derived(chaining_key, input);
    chaining_key = derived.out[0];
    set_key(derived.out[1]);
  }

  void mix_shared() noexcept {
    const Derived derived(chaining_key, shared);
    chaining_key = derived.out[0];
    mix_hash(derived.out[1]);
    set_key(derived.out[2]);
  }

  void mix_ephemeral(const PublicKey& ephemeral) noexcept {
    mix_hash(ephemeral.bytes);
    mix_key(ephemeral.bytes);  // as section 9.2 has it for patterns with a shared key
  }

  [[nodiscard]] std::size_t tag_bytes() const noexcept { return has_key ? kTagBytes : 0; }

  void encrypt(std::span<const std::byte> plain, std::span<std::byte> out) noexcept {
    if (has_key) {
      ::crypto_aead_chacha20poly1305_ietf_encrypt(raw(out), nullptr, raw(plain), plain.size(), raw(hash), hash.size(),
                                                  nullptr, nonce_of(nonce++).data(), raw(key));
    } else {
      std::ranges::copy(plain, out.begin());
    }
    mix_hash(out);
  }

  [[nodiscard]] bool decrypt(std::span<const std::byte> sealed, std::span<std::byte> out) noexcept {
    if (!has_key) {
      std::ranges::copy(sealed, out.begin());
    } else if (::crypto_aead_chacha20poly1305_ietf_decrypt(raw(out), nullptr, nullptr, raw(sealed), sealed.size(),
                                                           raw(hash), hash.size(), nonce_of(nonce++).data(),
                                                           raw(key)) != 0) {
      return false;
    }
    mix_hash(sealed);
    return true;
  }

  [[nodiscard]] bool mix_product(const KeyBytes& secret, const PublicKey& with) noexcept {
    KeyBytes product{};
    const bool made = ::crypto_scalarmult(raw(product), raw(secret), raw(with.bytes)) == 0;
    if (made) mix_key(product);
    wipe(product.data(), product.size());
    return made;
  }

  /// The tokens that are the same for who writes and who reads. False: a weak key.
  [[nodiscard]] bool mix(Token token) noexcept {
    const bool begins = role == Role::initiator;
    switch (token) {
      case Token::psk:
        mix_shared();
        return true;
      case Token::ee:
        return mix_product(own_ephemeral_secret, peer_ephemeral);
      case Token::es:
        return begins ? mix_product(own_ephemeral_secret, peer) : mix_product(own_secret, peer_ephemeral);
      case Token::se:
        return begins ? mix_product(own_secret, peer_ephemeral) : mix_product(own_ephemeral_secret, peer);
      case Token::ss:
        return mix_product(own_secret, peer);
      case Token::e:
      case Token::s:
        break;
    }
    return false;
  }

  [[nodiscard]] HandshakeResult write(std::span<const std::byte> payload, std::span<std::byte> out,
                                      const KeyBytes& random) noexcept {
    for (const Token token : tokens_of(pattern, messages)) {
      if (token == Token::e) {
        own_ephemeral_secret = random;
        ::crypto_scalarmult_base(raw(own_ephemeral.bytes), raw(own_ephemeral_secret));
        std::ranges::copy(own_ephemeral.bytes, take(out, kKeyBytes).begin());
        mix_ephemeral(own_ephemeral);
      } else if (token == Token::s) {
        encrypt(own.bytes, take(out, kKeyBytes + tag_bytes()));
      } else if (!mix(token)) {
        return HandshakeResult::weak_key;
      }
    }
    encrypt(payload, out.first(payload.size() + tag_bytes()));
    ++messages;
    return HandshakeResult::done;
  }

  [[nodiscard]] HandshakeResult read(std::span<const std::byte> message, std::span<std::byte> out) noexcept {
    for (const Token token : tokens_of(pattern, messages)) {
      if (token == Token::e) {
        std::ranges::copy(take(message, kKeyBytes), peer_ephemeral.bytes.begin());
        mix_ephemeral(peer_ephemeral);
      } else if (token == Token::s) {
        if (!decrypt(take(message, kKeyBytes + tag_bytes()), peer.bytes)) return HandshakeResult::not_authentic;
      } else if (!mix(token)) {
        return HandshakeResult::weak_key;
      }
    }
    if (!decrypt(message, out)) return HandshakeResult::not_authentic;
    ++messages;
    return HandshakeResult::done;
  }
};

struct Handshake::Both {
  State now;
  State next;
};

Handshake::Handshake(const HandshakeSetup& setup) {
  const bool ik = setup.pattern == Pattern::ik_psk2;
  const bool begins = setup.role == Role::initiator;
  if (ik && setup.own == nullptr) throw std::invalid_argument("a handshake of the pattern IKpsk2 needs a key pair");
  if (ik && begins && setup.peer == nullptr) {
    throw std::invalid_argument("who begins a handshake of the pattern IKpsk2 needs the other's public key");
  }
  if (!ik && setup.shared == nullptr)
    throw std::invalid_argument("a handshake of the pattern NNpsk0 needs a shared key");

  State& state = both_->now;
  state.pattern = setup.pattern;
  state.role = setup.role;
  const std::string_view name = protocol_of(setup.pattern);
  std::ranges::copy(std::as_bytes(std::span(name)), state.hash.begin());
  state.chaining_key = state.hash;
  if (setup.shared != nullptr) state.shared = **setup.shared;
  state.mix_hash(setup.prologue);
  if (!ik) return;
  state.own_secret = *setup.own->secret;
  state.own = setup.own->public_key;
  if (begins) state.peer = *setup.peer;
  state.mix_hash(begins ? state.peer.bytes : state.own.bytes);
}

Handshake::~Handshake() = default;
Handshake::Handshake(Handshake&&) noexcept = default;
Handshake& Handshake::operator=(Handshake&&) noexcept = default;

std::size_t Handshake::overhead(Pattern pattern, int message) noexcept {
  const bool names_itself = pattern == Pattern::ik_psk2 && message == 0;
  return kKeyBytes + kTagBytes + (names_itself ? kKeyBytes + kTagBytes : 0);
}

HandshakeMessage Handshake::write(std::span<const std::byte> payload, std::span<std::byte> out,
                                  const KeyBytes& random) noexcept {
  State& now = both_->now;
  State& next = both_->next;
  if (!now.writes_now()) return {.result = HandshakeResult::out_of_turn};
  const std::size_t bytes = overhead(now.pattern, now.messages) + payload.size();
  if (out.size() < bytes) return {.result = HandshakeResult::no_room};
  next = now;
  const HandshakeResult result = next.write(payload, out, random);
  if (result == HandshakeResult::done) now = next;
  wipe(&next, sizeof next);
  return {result, result == HandshakeResult::done ? bytes : 0};
}

HandshakeMessage Handshake::read(std::span<const std::byte> message, std::span<std::byte> out) noexcept {
  State& now = both_->now;
  State& next = both_->next;
  if (!now.reads_now()) return {.result = HandshakeResult::out_of_turn};
  const std::size_t more = overhead(now.pattern, now.messages);
  if (message.size() < more) return {.result = HandshakeResult::too_short};
  const std::size_t bytes = message.size() - more;
  if (out.size() < bytes) return {.result = HandshakeResult::no_room};
  next = now;
  const HandshakeResult result = next.read(message, out);
  if (result == HandshakeResult::done) now = next;
  wipe(&next, sizeof next);
  return {result, result == HandshakeResult::done ? bytes : 0};
}

const PublicKey& Handshake::peer() const noexcept { return both_->now.peer; }

const std::array<std::byte, kHandshakeHashBytes>& Handshake::hash() const noexcept { return both_->now.hash; }

void Handshake::split(TransportKeys& keys) const noexcept {
  const State& now = both_->now;
  const Derived derived(now.chaining_key, {});
  const bool begins = now.role == Role::initiator;
  copy_key(keys.send, derived.out[begins ? 0 : 1]);
  copy_key(keys.receive, derived.out[begins ? 1 : 0]);
}

}  // namespace forcebound::security
