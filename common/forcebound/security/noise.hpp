#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "forcebound/security/keys.hpp"
#include "forcebound/security/locked.hpp"

namespace forcebound::security {

/// Who knows what before a handshake (Noise protocol framework, revision 34, sections 7 and 9).
enum class Pattern : std::uint8_t {
  ik_psk2,  ///< the initiator knows the responder's public key and shows its own; a shared key is optional
  nn_psk0,  ///< both know a shared key, and nothing else
};

/// IKpsk2 or NNpsk0.
[[nodiscard]] std::string_view name_of(Pattern pattern) noexcept;

enum class Role : std::uint8_t { initiator, responder };

/// What a handshake is begun with. Nothing of it need outlive the constructor of Handshake.
struct HandshakeSetup {
  Pattern pattern = Pattern::ik_psk2;
  Role role = Role::initiator;
  std::span<const std::byte> prologue{};  ///< what both must agree on; the handshake fails where it differs
  const KeyPair* own = nullptr;           ///< ik_psk2
  const PublicKey* peer = nullptr;        ///< the responder's: ik_psk2, initiator
  const SecretKey* shared = nullptr;      ///< nn_psk0 must have it; ik_psk2 without: 32 zero bytes
};

enum class HandshakeResult : std::uint8_t {
  done,
  out_of_turn,    ///< the other one writes now, or the handshake is over
  too_short,      ///< a message that lacks what its pattern says
  no_room,        ///< `out` is too small
  weak_key,       ///< a public key of low order
  not_authentic,  ///< forged or damaged; or another key, shared key or prologue
};

struct HandshakeMessage {
  HandshakeResult result = HandshakeResult::done;
  std::size_t bytes = 0;  ///< of `out` that were written
};

/// Keys for what follows a handshake: one for each direction. Keep them in a Locked, or wipe them after use.
struct TransportKeys {
  KeyBytes send{};
  KeyBytes receive{};
};

inline constexpr std::size_t kTagBytes = 16;
inline constexpr std::size_t kHandshakeHashBytes = 64;

/// The two messages of Noise_IKpsk2_25519_ChaChaPoly_BLAKE2b or Noise_NNpsk0_25519_ChaChaPoly_BLAKE2b, after which
/// both ends have the same keys that nobody else has. Payloads travel with the messages; the first one's may be
/// replayed by anybody who saw it, and be read by who gets the responder's or the shared key later.
///
///     initiator.write(...) -> responder.read(...) -> responder.write(...) -> initiator.read(...); both: split(...)
///
/// A message that `read` refuses changes nothing, so that a forged answer does not keep the true one out.
///
/// Not for the tick's thread: up to four products on the curve for each message, about 0.2 ms. No allocation after
/// construction. Not thread-safe.
class Handshake {
 public:
  /// @throws std::invalid_argument if a key is missing that the pattern needs
  explicit Handshake(const HandshakeSetup& setup);
  ~Handshake();
  Handshake(Handshake&&) noexcept;
  Handshake& operator=(Handshake&&) noexcept;

  /// How many bytes a message is longer than its payload. @param message 0 or 1
  [[nodiscard]] static std::size_t overhead(Pattern pattern, int message) noexcept;

  /// @param random 32 bytes that nobody can guess and nobody uses again; wipe them afterwards
  [[nodiscard]] HandshakeMessage write(std::span<const std::byte> payload, std::span<std::byte> out,
                                       const KeyBytes& random) noexcept;

  /// @param out for the payload; must not overlap the message
  [[nodiscard]] HandshakeMessage read(std::span<const std::byte> message, std::span<std::byte> out) noexcept;

  /// ik_psk2: the other one's public key; at the responder, after it has read a message. Until the first record is
  /// opened, a replayed message may have named it.
  [[nodiscard]] const PublicKey& peer() const noexcept;

  /// The same at both ends and for no other handshake; after the handshake.
  [[nodiscard]] const std::array<std::byte, kHandshakeHashBytes>& hash() const noexcept;

  /// After the handshake.
  void split(TransportKeys& keys) const noexcept;

 private:
  struct State;
  struct Both;

  // The one after the message at hand takes the place of the other only where all went well.
  Locked<Both> both_;
};

}  // namespace forcebound::security
