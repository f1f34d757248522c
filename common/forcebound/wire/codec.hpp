#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>

#include "forcebound/wire/messages.hpp"

namespace forcebound::wire {

/// No datagram of ours is longer, and a Hello is always as long: so no answer is larger than its question, and nobody
/// can use a server to flood a third party.
inline constexpr std::size_t kFrameBytesMax = 1200;

/// Longer names (device, scene) and texts (what is simulated, why refused) are cut to this many bytes of UTF-8.
inline constexpr std::size_t kNameBytesMax = 64;
inline constexpr std::size_t kTextBytesMax = 1000;

/// Why a datagram was dropped. Each is counted; none is an error of ours.
enum class Malformed : std::uint8_t {
  oversize,    ///< longer than a datagram of ours may be
  truncated,   ///< shorter than the frame's header
  foreign,     ///< does not begin with our mark, or of another frame version
  corrupt,     ///< the checksum disagrees
  unreadable,  ///< the body is not the message it says it is; a short Hello and motion without position are none either
  non_finite,  ///< a number in it is not finite, a vector has more than six rows or a port more than 16 numbers
};
inline constexpr std::size_t kMalformedReasons = 6;

/// Turns messages into datagrams and back.
///
/// A datagram is a frame header of eight bytes and a Protocol Buffers body:
///
///     'F' 'B' | frame version 1 | kind 1..6, the index in Message + 1 | CRC-32 of kind and body, little-endian | body
///
/// The checksum (zlib's) is ours because UDP's is rewritten by every relay on the way.
///
/// Real time: reused inside; after construction, encoding and decoding allocate nothing. (Decoding a datagram that is
/// not of ours, but framed as one, may allocate what fits its 1200 bytes.) Not thread-safe.
class Codec {
 public:
  Codec();
  ~Codec();
  Codec(Codec&&) noexcept;
  Codec& operator=(Codec&&) noexcept;

  /// The datagram, valid until the next `encode`. Text that does not fit is cut.
  [[nodiscard]] std::span<const std::byte> encode(const Message& message) noexcept;

  /// The message, or why there is none; text in it is valid until the codec is used again. `datagram` may be anything.
  [[nodiscard]] std::variant<Message, Malformed> decode(std::span<const std::byte> datagram) noexcept;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace forcebound::wire
