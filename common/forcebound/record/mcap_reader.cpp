#include "forcebound/record/mcap_reader.hpp"

#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "forcebound/record/internal/mcap_fields.hpp"
#include "forcebound/record/internal/zstd.hpp"

namespace forcebound::record::mcap {
namespace {

constexpr std::string_view kZstd = "zstd";
constexpr std::size_t kNameBytesMost = 1024;

/// A chunk's content apart from its records.
struct ChunkHead {
  std::uint64_t start = 0;  ///< byte of the chunk's content
  std::uint64_t size = 0;   ///< of the records, uncompressed
  std::uint32_t crc = 0;
  bool compressed = false;
  std::uint64_t stored = 0;  ///< bytes of the records in the file
};

class Reader {
 public:
  Reader(std::istream& in, const std::string& name, const Visitor& visitor)
      : in_(in), place_{name}, visitor_(visitor) {}

  Ending run();

 private:
  void measure();
  bool at_its_end(Opcode opcode, std::uint64_t begin, std::uint64_t length);
  void record(Opcode opcode, std::uint64_t offset, std::string_view content);
  std::string_view name_in(Fields& fields) const;
  void schema(Fields fields);
  void channel(Fields fields);
  void message(Fields fields, std::uint64_t offset);
  void attachment(Fields fields);
  ChunkHead chunk_head(Fields& fields);
  void chunk(Fields fields);
  void cut_chunk(std::uint64_t offset, std::string_view content);
  void expect_crc(std::uint32_t said, std::string_view bytes, std::uint64_t offset, const char* what) const;
  std::uint64_t records_of(std::string_view records, std::uint64_t offset, bool compressed, bool cut);

  std::istream& in_;
  Place place_;
  const Visitor& visitor_;
  Ending ending_;
  bool ended_ = false;  ///< the file's last bytes are those of a complete one
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

void Reader::measure() {
  std::string magic(kMagic.size(), '\0');
  in_.seekg(0, std::ios::end);
  ending_.size = in_ ? static_cast<std::uint64_t>(in_.tellg()) : 0;
  if (ending_.size >= 2 * kMagic.size()) {
    in_.seekg(-static_cast<std::streamoff>(kMagic.size()), std::ios::end);
    in_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
    ended_ = magic == kMagic;
  }
  in_.clear();
  in_.seekg(0);
  in_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (!in_ || magic != kMagic)
    place_.refuse(0, "not an MCAP file of version 0: the magic bytes at its start are missing");
}

/// Whether the record that begins there is not one to be visited: it ends the file, or is cut off.
bool Reader::at_its_end(Opcode opcode, std::uint64_t begin, std::uint64_t length) {
  const std::uint64_t left = ending_.size - begin - kRecordHeaderBytes;
  if (length > left || opcode == Opcode::none) {
    // A length may not exceed the rest of the file, so that a wrong one allocates no memory.
    if (!ended_) {
      ending_.kind = name_of(opcode);
      ending_.declared = length;
      return true;
    }
    if (opcode == Opcode::none) place_.refuse(begin, "a record of kind 0, which there is not");
    place_.refuse(begin + kRecordHeaderBytes, "a record of " + std::to_string(length) + " bytes, where the file has " +
                                                  std::to_string(left) + " left");
  }
  if (opcode != Opcode::footer) return false;
  ending_.complete = ended_;
  ending_.whole = begin + kRecordHeaderBytes + length;
  return true;
}

Ending Reader::run() {
  measure();
  ending_.whole = kMagic.size();
  std::string content;
  for (;;) {
    const std::uint64_t begin = ending_.whole;
    char head[kRecordHeaderBytes];
    in_.read(head, sizeof head);
    if (!in_) return ending_;
    Fields header(place_, begin, std::string_view(head, sizeof head));
    const Opcode opcode{header.number<std::uint8_t>()};
    const auto length = header.number<std::uint64_t>();
    const std::uint64_t offset = begin + kRecordHeaderBytes;
    const bool last = at_its_end(opcode, begin, length);
    if (last && (opcode != Opcode::chunk || ending_.complete)) return ending_;
    content.resize(last ? ending_.size - offset : length);
    in_.read(content.data(), static_cast<std::streamsize>(content.size()));
    if (!in_) place_.refuse(offset, "cannot be read: " + std::string(std::strerror(errno)));
    if (last) {
      cut_chunk(offset, content);
      return ending_;
    }
    if (opcode == Opcode::data_end) ending_.only_index_is_lost = true;
    record(opcode, offset, content);
    ending_.whole = offset + length;
  }
}

void Reader::record(Opcode opcode, std::uint64_t offset, std::string_view content) {
  const Fields fields(place_, offset, content);
  switch (opcode) {
    case Opcode::schema:
      return schema(fields);
    case Opcode::channel:
      return channel(fields);
    case Opcode::message:
      return message(fields, offset);
    case Opcode::chunk:
      return chunk(fields);
    case Opcode::attachment:
      return attachment(fields);
    case Opcode::metadata: {
      Fields metadata = fields;
      const std::string name(metadata.text());
      if (visitor_.metadata) visitor_.metadata(name, metadata.map());
      return;
    }
    default:
      return;  // indexes, and additions of later versions
  }
}

/// Names are kept for as long as the file is read, 65,536 of them at most.
std::string_view Reader::name_in(Fields& fields) const {
  const std::uint64_t offset = fields.offset();
  const std::string_view name = fields.text();
  if (name.size() <= kNameBytesMost) return name;
  place_.refuse(offset, "a name of " + std::to_string(name.size()) + " bytes; accepted are at most " +
                            std::to_string(kNameBytesMost));
}

void Reader::schema(Fields fields) {
  Schema schema;
  schema.id = fields.number<std::uint16_t>();
  schema.name = name_in(fields);
  schema.encoding = name_in(fields);
  fields.text();  // how it is written: known here
  schemas_[schema.id] = std::move(schema);
}

void Reader::channel(Fields fields) {
  Channel channel;
  channel.id = fields.number<std::uint16_t>();
  channel.schema_id = fields.number<std::uint16_t>();
  channel.topic = name_in(fields);
  channel.encoding = name_in(fields);
  channels_[channel.id] = std::move(channel);
}

void Reader::message(Fields fields, std::uint64_t offset) {
  Message message;
  message.offset = offset;
  const auto id = fields.number<std::uint16_t>();
  message.sequence = fields.number<std::uint32_t>();
  message.log_time = fields.number<std::uint64_t>();
  fields.number<std::uint64_t>();  // publish time
  message.data = fields.rest();
  const auto channel = channels_.find(id);
  if (channel == channels_.end()) {
    place_.refuse(message.offset, "a message of channel " + std::to_string(id) + ", which was not declared before it");
  }
  const Schema none;
  const auto schema = schemas_.find(channel->second.schema_id);
  if (visitor_.message) visitor_.message(schema == schemas_.end() ? none : schema->second, channel->second, message);
}

void Reader::attachment(Fields fields) {
  const std::string_view all = fields.rest();
  const std::uint64_t offset = fields.offset();
  Attachment attachment;
  attachment.log_time = fields.number<std::uint64_t>();
  fields.number<std::uint64_t>();  // time of creation
  attachment.name = fields.text();
  attachment.media_type = fields.text();
  attachment.data = fields.take(fields.number<std::uint64_t>());
  const std::string_view covered = all.substr(0, all.size() - fields.rest().size());
  expect_crc(fields.number<std::uint32_t>(), covered, offset, "attachment");
  if (visitor_.attachment) visitor_.attachment(attachment);
}

void Reader::expect_crc(std::uint32_t said, std::string_view bytes, std::uint64_t offset, const char* what) const {
  const auto actual =
      static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  if (said == 0 || said == actual) return;  // 0: none was made
  char text[96];
  std::snprintf(text, sizeof text, "the %s is damaged: its CRC-32 is 0x%08x, the file says 0x%08x", what, actual, said);
  place_.refuse(offset, text);
}

ChunkHead Reader::chunk_head(Fields& fields) {
  ChunkHead head{.start = fields.offset()};
  fields.number<std::uint64_t>();  // earliest and latest log time
  fields.number<std::uint64_t>();
  head.size = fields.number<std::uint64_t>();
  head.crc = fields.number<std::uint32_t>();
  const std::string compression(fields.text());
  head.compressed = !compression.empty();
  if (head.compressed && compression != kZstd) {
    place_.refuse(head.start, "a chunk compressed with '" + compression +
                                  "'; accepted are zstd and none ('mcap compress --compression zstd' makes them)");
  }
  if (head.compressed && head.size > kChunkBytesMost) {
    place_.refuse(head.start, "a compressed chunk that would hold " + std::to_string(head.size) +
                                  " bytes; accepted are at most " + std::to_string(kChunkBytesMost));
  }
  head.stored = fields.number<std::uint64_t>();
  return head;
}

void Reader::chunk(Fields fields) {
  const ChunkHead head = chunk_head(fields);
  const std::uint64_t offset = fields.offset();
  std::string_view records = fields.take(head.stored);
  Decompressed decompressed;
  if (head.compressed) {
    decompressed = decompress(records, head.size);
    const std::uint64_t got = decompressed.bytes.size();
    if (!decompressed.problem.empty()) {
      place_.refuse(head.start, "the compressed chunk is damaged: " + decompressed.problem);
    }
    if (got != head.size) {
      place_.refuse(head.start, "a compressed chunk that holds " + std::to_string(got) + " bytes, where it says " +
                                    std::to_string(head.size));
    }
    records = decompressed.bytes;
  }
  expect_crc(head.crc, records, head.start, "chunk");
  ending_.stored += head.stored;
  ending_.uncompressed += records.size();
  records_of(records, head.compressed ? head.start : offset, head.compressed, false);
}

/// Visits what is whole at the beginning of a chunk that the file's end cuts off.
void Reader::cut_chunk(std::uint64_t offset, std::string_view content) {
  constexpr std::size_t kFixed = 8 + 8 + 8 + 4 + 4 + 8;  // with an empty name of the compression
  if (content.size() < kFixed + kZstd.size()) return;
  Fields fields(place_, offset, content);
  const ChunkHead head = chunk_head(fields);
  if (!head.compressed) {
    // Zeros after a loss of power may begin within a record, which is cut off there.
    const std::string_view rest = fields.rest();
    ending_.rescued = records_of(rest.substr(0, rest.find_last_not_of('\0') + 1), fields.offset(), false, true);
    return;
  }
  const Decompressed decompressed = decompress(fields.rest(), head.size);
  ending_.rescued = records_of(decompressed.bytes, head.start, true, true);
}

/// @param offset of the records, or where they are compressed that of their chunk
/// @param cut the last record may be cut off; else it is refused
/// @returns the messages among them
std::uint64_t Reader::records_of(std::string_view records, std::uint64_t offset, bool compressed, bool cut) {
  std::uint64_t messages = 0;
  Fields inner(place_, offset, records);
  while (!inner.rest().empty()) {
    if (cut && inner.rest().size() < kRecordHeaderBytes) break;
    const Opcode opcode{inner.number<std::uint8_t>()};
    const auto size = inner.number<std::uint64_t>();
    const std::uint64_t at = compressed ? offset : inner.offset();
    if (cut && size > inner.rest().size()) break;
    const std::string_view content = inner.take(size);
    if (opcode == Opcode::chunk) place_.refuse(at, "a chunk within a chunk");
    if (opcode == Opcode::none) place_.refuse(at, "a record of kind 0, which there is not");
    record(opcode, at, content);
    messages += opcode == Opcode::message ? 1U : 0U;
  }
  return messages;
}

}  // namespace

std::string in_words(const Ending& ending) {
  if (ending.complete) return {};
  std::string words = "it ends at byte " + std::to_string(ending.size);
  if (ending.only_index_is_lost) return words + ", within the index behind its last record: all records are there";
  if (ending.whole == ending.size) return words + ", behind a whole record";
  if (ending.kind.empty()) return words + "; from byte " + std::to_string(ending.whole) + " on it has no whole record";
  words += ", within a " + ending.kind + " of " + std::to_string(ending.declared) + " bytes that begins at byte " +
           std::to_string(ending.whole);
  if (ending.rescued > 0) words += ", of which the first " + std::to_string(ending.rescued) + " messages are whole";
  return words;
}

Ending read(std::istream& in, const std::string& name, const Visitor& visitor) {
  return Reader(in, name, visitor).run();
}

}  // namespace forcebound::record::mcap
