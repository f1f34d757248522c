#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <variant>

#include "forcebound/wire/frame_size.hpp"
#include "forcebound/wire/malformed.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::wire {

/// Longer names (device, scene) and texts (what is simulated, why refused) are cut to this many bytes of UTF-8.
inline constexpr std::size_t kNameBytesMax = 64;
inline constexpr std::size_t kTextBytesMax = 1000;

/// The index of a type in a variant.
template <class Type, class... Types>
constexpr std::size_t index_in(const std::variant<Types...>* /*variant*/) noexcept {
  std::size_t index = 0;
  (void)((!std::is_same_v<Type, Types> && (++index, true)) && ...);
  return index;
}

/// What a datagram is, as far as its first bytes tell: enough to drop most of a flood without reading its body.
struct Heading {
  /// That of a type in Message: its index; larger: of none.
  std::size_t kind = 0;
  /// The session of a motion, force, Bye, piece or refused motion; 0 if another field precedes it, which no encoder of
  /// Protocol Buffers does, or if it is 0.
  std::uint64_t session = 0;
  std::uint64_t client_nonce = 0;  ///< of a Welcome or a refused Hello, else 0

  template <class Type>
  [[nodiscard]] bool is() const noexcept {
    return kind == index_in<Type>(static_cast<const Message*>(nullptr));
  }
};

/// The heading of a datagram with the protocol's mark and the right checksum, or why it has none. The body may still be
/// malformed. `datagram` is untrusted.
///
/// Real time: noexcept, no allocation, O(bytes) for the checksum alone.
[[nodiscard]] std::variant<Heading, Malformed> heading_of(std::span<const std::byte> datagram) noexcept;

/// Turns messages into datagrams and back.
///
/// A datagram is a frame header of eight bytes and a Protocol Buffers body:
///
///     'F' 'B' | frame version 1 | kind 1..8, the index in Message + 1 | CRC-32 of kind and body, little-endian | body
///
/// The checksum (zlib's) is ours because UDP's is rewritten by every relay on the way. The frame version is not the
/// protocol's, which a Hello names: it stays as it is, so that programs of different protocol versions can read each
/// other's Hello and Refusal.
///
/// Real time: memory is reused; after construction, encoding and decoding allocate nothing, whatever somebody sends.
/// Not thread-safe.
class Codec {
 public:
  Codec();
  ~Codec();
  Codec(Codec&&) noexcept;
  Codec& operator=(Codec&&) noexcept;

  /// The datagram, valid until the next `encode`. Text that does not fit is cut.
  [[nodiscard]] std::span<const std::byte> encode(const Message& message) noexcept;

  /// The same without a copy into a Message, which is large.
  [[nodiscard]] std::span<const std::byte> encode(const EnvironmentForce& force) noexcept;

  /// The message, or why there is none; text in it is valid until the codec is used again. `datagram` is untrusted.
  [[nodiscard]] std::variant<Message, Malformed> decode(std::span<const std::byte> datagram) noexcept;

  /// The same for a datagram whose heading `heading_of` has read.
  [[nodiscard]] std::variant<Message, Malformed> decode(std::span<const std::byte> datagram,
                                                        const Heading& heading) noexcept;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace forcebound::wire
