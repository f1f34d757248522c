#include "forcebound/wire/internal/known_fields.hpp"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/stubs/common.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <cstdint>

namespace forcebound::wire {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::internal::WireFormatLite;

bool is_read_as(const FieldDescriptor& field, WireFormatLite::WireType type) noexcept {
  const auto own = WireFormatLite::WireTypeForFieldType(static_cast<WireFormatLite::FieldType>(field.type()));
  return type == own || (field.is_packable() && type == WireFormatLite::WIRETYPE_LENGTH_DELIMITED);
}

}  // namespace

std::optional<std::span<const std::byte>> KnownFields::of(const Descriptor& schema,
                                                          std::span<const std::byte> body) noexcept {
  bytes_ = 0;
  messages_ = 0;
  if (body.size() > kFrameBytesMax || !copy(schema, body)) return std::nullopt;
  return std::span<const std::byte>(kept_).first(bytes_);
}

bool KnownFields::copy(const Descriptor& schema, std::span<const std::byte> from) noexcept {
  google::protobuf::io::CodedInputStream in(reinterpret_cast<const std::uint8_t*>(from.data()),
                                            static_cast<int>(from.size()));
  const auto at = [&in] { return static_cast<std::size_t>(in.CurrentPosition()); };
  while (at() < from.size()) {
    const std::size_t begin = at();
    const std::uint32_t tag = in.ReadTag();
    const std::size_t after_tag = at();
    std::size_t content = after_tag;
    const WireFormatLite::WireType type = WireFormatLite::GetTagWireType(tag);
    if (type == WireFormatLite::WIRETYPE_LENGTH_DELIMITED) {
      std::uint32_t length = 0;
      if (!in.ReadVarint32(&length) || length > from.size()) return false;
      content = at();
      if (!in.Skip(static_cast<int>(length))) return false;
    } else if (!WireFormatLite::SkipField(&in, tag)) {  // also of the tag 0, which is none
      return false;
    }
    const FieldDescriptor* const field = schema.FindFieldByNumber(WireFormatLite::GetTagFieldNumber(tag));
    if (field == nullptr || !is_read_as(*field, type)) continue;
    const auto value = from.subspan(content, at() - content);
    if (field->type() == FieldDescriptor::TYPE_STRING &&
        !google::protobuf::internal::IsStructurallyValidUTF8(reinterpret_cast<const char*>(value.data()),
                                                             static_cast<int>(value.size()))) {
      return false;
    }
    if (field->type() != FieldDescriptor::TYPE_MESSAGE) {
      append(from.subspan(begin, at() - begin));
    } else if (messages_++ < kMessagesMax) {
      append(from.subspan(begin, after_tag - begin));
      if (!copy_message(*field->message_type(), value)) return false;
    }
  }
  return true;
}

/// With its length in two bytes, whatever is left of it.
bool KnownFields::copy_message(const Descriptor& schema, std::span<const std::byte> content) noexcept {
  static_assert(kFrameBytesMax < 1U << 14U, "has a length of two bytes");
  const std::size_t length_at = bytes_;
  bytes_ += kLengthBytes;
  if (!copy(schema, content)) return false;
  const std::size_t length = bytes_ - length_at - kLengthBytes;
  kept_[length_at] = static_cast<std::byte>(0x80U | (length & 0x7FU));
  kept_[length_at + 1] = static_cast<std::byte>(length >> 7U);
  return true;
}

void KnownFields::append(std::span<const std::byte> bytes) noexcept {
  std::ranges::copy(bytes, kept_.begin() + static_cast<std::ptrdiff_t>(bytes_));
  bytes_ += bytes.size();
}

}  // namespace forcebound::wire
