#include "forcebound/record/internal/mcap_index.hpp"

#include <zlib.h>

#include <array>
#include <cstdio>

#include "forcebound/record/internal/mcap_fields.hpp"

namespace forcebound::record::mcap {
namespace {

constexpr std::uint64_t kFooterContent = 8 + 8 + 4;
constexpr std::uint64_t kFooterBytes = kRecordHeaderBytes + kFooterContent;

/// Names are kept for as long as the file is read, 65,536 of them at most.
std::string name_in(Fields& fields) {
  constexpr std::size_t kNameBytesMost = 1024;
  const std::uint64_t offset = fields.offset();
  const std::string_view name = fields.text();
  if (name.size() <= kNameBytesMost) return std::string(name);
  throw Damage(offset, "a name of " + std::to_string(name.size()) + " bytes; accepted are at most " +
                           std::to_string(kNameBytesMost));
}

/// One record of the index.
void add(FileIndex& index, Opcode opcode, std::uint64_t offset, std::string_view content) {
  Fields fields(offset, content);
  RecordPlace place;
  std::uint64_t begin = 0;
  switch (opcode) {
    case Opcode::schema: {
      Schema schema = schema_in(offset, content);
      index.schemas[schema.id] = std::move(schema);
      return;
    }
    case Opcode::channel: {
      Channel channel = channel_in(offset, content);
      index.channels[channel.id] = std::move(channel);
      return;
    }
    case Opcode::statistics:
      index.messages = fields.number<std::uint64_t>();
      return;
    case Opcode::chunk_index:
      fields.take(2 * sizeof(std::uint64_t));  // earliest and latest log time
      place.opcode = Opcode::chunk;
      break;
    case Opcode::attachment_index:
      place.opcode = Opcode::attachment;
      break;
    case Opcode::metadata_index:
      place.opcode = Opcode::metadata;
      break;
    default:
      return;
  }
  begin = fields.number<std::uint64_t>();
  place.length = fields.number<std::uint64_t>();  // with opcode and length
  if (opcode == Opcode::metadata_index) place.name = fields.text();
  if (place.length < kRecordHeaderBytes || begin > index.end || place.length > index.end - begin) return;
  place.length -= kRecordHeaderBytes;
  index.places[begin] = std::move(place);
}

std::string bytes_at(std::istream& in, std::uint64_t begin, std::uint64_t count) {
  std::string bytes(count, '\0');
  in.clear();
  in.seekg(static_cast<std::streamoff>(begin));
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  return in ? bytes : std::string();
}

/// Whether a record of a kind that there is begins there and fits in; `at` goes to its end.
bool is_record(std::string_view bytes, std::size_t& at) {
  Fields header(at, bytes.substr(at, kRecordHeaderBytes));
  const auto opcode = header.number<std::uint8_t>();
  const auto length = header.number<std::uint64_t>();
  if (opcode == 0 || name_of(Opcode{opcode}).empty() || length > bytes.size() - at - kRecordHeaderBytes) return false;
  at += kRecordHeaderBytes + length;
  return true;
}

}  // namespace

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before) noexcept {
  return static_cast<std::uint32_t>(crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void expect_crc(std::uint32_t stated, std::string_view bytes, std::uint64_t offset, const char* what) {
  const std::uint32_t actual = crc32_of(bytes);
  if (stated == 0 || stated == actual) return;  // 0: none was made
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "the %s is damaged: its CRC-32 is 0x%08x, the file says 0x%08x", what, actual,
                stated);
  throw Damage(offset, text.data());
}

Schema schema_in(std::uint64_t offset, std::string_view content) {
  Fields fields(offset, content);
  Schema schema;
  schema.id = fields.number<std::uint16_t>();
  schema.name = name_in(fields);
  schema.encoding = name_in(fields);
  fields.text();  // how it is written: known here
  return schema;
}

Channel channel_in(std::uint64_t offset, std::string_view content) {
  Fields fields(offset, content);
  Channel channel;
  channel.id = fields.number<std::uint16_t>();
  channel.schema_id = fields.number<std::uint16_t>();
  channel.topic = name_in(fields);
  channel.encoding = name_in(fields);
  return channel;
}

std::optional<FileIndex> read_index(std::istream& in, std::uint64_t size) {
  if (size < 2 * kMagic.size() + kFooterBytes) return std::nullopt;
  const std::uint64_t footer_at = size - kMagic.size() - kFooterBytes;
  const std::string footer = bytes_at(in, footer_at, kFooterBytes);
  if (footer.empty()) return std::nullopt;
  Fields fields(footer_at, footer);
  const Opcode opcode{fields.number<std::uint8_t>()};
  const auto length = fields.number<std::uint64_t>();
  FileIndex index;
  index.end = fields.number<std::uint64_t>();
  fields.number<std::uint64_t>();  // where the offsets of its groups begin
  const auto crc = fields.number<std::uint32_t>();
  if (opcode != Opcode::footer || length != kFooterContent) throw Damage(footer_at, "the footer is damaged");
  if (index.end == 0 || crc == 0) return std::nullopt;
  if (index.end > footer_at || footer_at - index.end > kChunkBytesMost) {
    throw Damage(footer_at, "the footer is damaged: an index that begins at byte " + std::to_string(index.end));
  }
  const std::string bytes = bytes_at(in, index.end, footer_at - index.end) + footer;
  expect_crc(crc, std::string_view(bytes).substr(0, bytes.size() - sizeof crc), index.end, "index");
  Fields records(index.end, std::string_view(bytes).substr(0, bytes.size() - kFooterBytes));
  while (!records.rest().empty()) {
    const Opcode kind{records.number<std::uint8_t>()};
    const auto bytes_of_it = records.number<std::uint64_t>();
    const std::uint64_t offset = records.offset();
    add(index, kind, offset, records.take(bytes_of_it));
  }
  return index;
}

std::optional<std::size_t> find_records(std::string_view bytes) {
  constexpr int kEnough = 4;
  for (std::size_t begin = 0; begin + kRecordHeaderBytes < bytes.size(); ++begin) {
    const Opcode first{static_cast<std::uint8_t>(bytes[begin])};
    if (first < Opcode::chunk) continue;
    std::size_t at = begin;
    int found = 0;
    while (found < kEnough && at + kRecordHeaderBytes <= bytes.size() && is_record(bytes, at)) ++found;
    const std::string_view rest = bytes.substr(at);
    if (found == kEnough || (found > 0 && (rest.empty() || rest == kMagic))) return begin;
  }
  return std::nullopt;
}

}  // namespace forcebound::record::mcap
