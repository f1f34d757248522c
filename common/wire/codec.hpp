#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>

#include "forcebound/wire/messages.hpp"

namespace forcebound::wire {

/// Why a datagram was dropped. Each is counted; none is an error of ours.
enum class Malformed : std::uint8_t {
  oversize,    ///< longer than a datagram of ours may be
  truncated,   ///< shorter than the frame's header
  foreign,     ///< does not begin with our mark, or of another frame version
  corrupt,     ///< the checksum disagrees
  unreadable,  ///< the body is not the message it says it is
  non_finite,  ///< a number in it is not finite, or a vector has more than six rows
};
inline constexpr std::size_t kMalformedReasons = 6;

/// Turns messages into datagrams and back.
///
/// A datagram is a frame header (mark "FB", frame version, kind, CRC-32 of the body) and a Protocol Buffers body. The
/// checksum is ours because UDP's is rewritten by every relay on the way.
///
/// Real time: reused inside; after construction, encoding and decoding allocate nothing. Not thread-safe.
class Codec {
 public:
  Codec();
  ~Codec();
  Codec(Codec&&) noexcept;
  Codec& operator=(Codec&&) noexcept;

  /// The datagram, valid until the next `encode`. Text that does not fit is cut.
  [[nodiscard]] std::span<const std::byte> encode(const Message& message) noexcept;

  /// The message, or why there is none; text in it is valid until the next `decode`. `datagram` may be anything.
  [[nodiscard]] std::variant<Message, Malformed> decode(std::span<const std::byte> datagram) noexcept;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace forcebound::wire
