#pragma once

#include <google/protobuf/descriptor.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "forcebound/wire/frame_size.hpp"

/// Private to wire.
namespace forcebound::wire {

/// What a schema knows of a body from anybody. Protocol Buffers keeps all the rest as well, in memory that nobody can
/// reserve: fields of unknown numbers or of other types, and messages within the message, however many. It also writes
/// an error, in memory of its own, where a text is not UTF-8.
///
/// Real time: no allocation.
class KnownFields {
 public:
  /// Of messages within a message; more are left out. One more than a valid body has.
  static constexpr int kMessagesMax = 6;

  /// The body less what the schema does not know, valid until the next call; nullopt if it cannot be read.
  /// @param body no longer than a datagram
  [[nodiscard]] std::optional<std::span<const std::byte>> of(const google::protobuf::Descriptor& schema,
                                                             std::span<const std::byte> body) noexcept;

 private:
  static constexpr std::size_t kLengthBytes = 2;

  [[nodiscard]] bool copy(const google::protobuf::Descriptor& schema, std::span<const std::byte> from) noexcept;
  [[nodiscard]] bool copy_message(const google::protobuf::Descriptor& schema,
                                  std::span<const std::byte> content) noexcept;
  void append(std::span<const std::byte> bytes) noexcept;

  // A message's length may become longer by one byte.
  std::array<std::byte, kFrameBytesMax + kMessagesMax> kept_{};
  std::size_t bytes_ = 0;
  int messages_ = 0;
};

}  // namespace forcebound::wire
