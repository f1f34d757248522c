#include "forcebound/record/mcap_reader.hpp"

#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace forcebound::record::mcap {
namespace {

/// Errors that name file and byte.
struct Place {
  const std::string& file;
  [[noreturn]] void refuse(std::uint64_t byte, const std::string& what) const {
    throw std::runtime_error(file + ": byte " + std::to_string(byte) + ": " + what);
  }
};

/// Takes a record's content apart.
class Fields {
 public:
  Fields(const Place& place, std::uint64_t offset, std::string_view content)
      : place_(place), offset_(offset), rest_(content) {}

  template <std::unsigned_integral Number>
  Number number() {
    const std::string_view bytes = take(sizeof(Number));
    Number value = 0;
    for (std::size_t i = sizeof(Number); i-- > 0;) {
      value = static_cast<Number>((std::uint64_t{value} << 8U) | static_cast<unsigned char>(bytes[i]));
    }
    return value;
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view take(std::uint64_t count) {
    if (count > rest_.size()) {
      place_.refuse(offset_, "a field of " + std::to_string(count) + " bytes does not fit in the " +
                                 std::to_string(rest_.size()) + " left of its record");
    }
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    offset_ += count;
    return bytes;
  }
  std::map<std::string, std::string> map() {
    std::map<std::string, std::string> values;
    const std::uint64_t start = offset_ + sizeof(std::uint32_t);
    Fields entries(place_, start, text());
    while (!entries.rest().empty()) {
      std::string key(entries.text());
      values[std::move(key)] = entries.text();
    }
    return values;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

 private:
  const Place& place_;
  std::uint64_t offset_;
  std::string_view rest_;
};

class Reader {
 public:
  Reader(std::istream& in, const std::string& name, const Visitor& visitor)
      : in_(in), place_{name}, visitor_(visitor) {}

  bool run();

 private:
  void measure();
  void record(Opcode opcode, std::uint64_t offset, std::string_view content);
  void schema(Fields fields);
  void channel(Fields fields);
  void message(Fields fields);
  void chunk(Fields fields);

  std::istream& in_;
  Place place_;
  const Visitor& visitor_;
  std::uint64_t size_ = 0;
  bool ended_ = false;  ///< the file's last bytes are those of a complete one
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

void Reader::measure() {
  std::string magic(kMagic.size(), '\0');
  in_.seekg(0, std::ios::end);
  size_ = in_ ? static_cast<std::uint64_t>(in_.tellg()) : 0;
  if (size_ >= 2 * kMagic.size()) {
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

bool Reader::run() {
  measure();
  std::uint64_t offset = kMagic.size();
  std::string content;
  for (;;) {
    char head[kRecordHeaderBytes];
    in_.read(head, sizeof head);
    if (!in_) return false;
    Fields header(place_, offset, std::string_view(head, sizeof head));
    const Opcode opcode{header.number<std::uint8_t>()};
    const auto length = header.number<std::uint64_t>();
    offset += kRecordHeaderBytes;
    if (length > size_ - offset) {
      // A length may not exceed the rest of the file, so that a wrong one allocates no memory.
      if (!ended_) return false;
      place_.refuse(offset, "a record of " + std::to_string(length) + " bytes, where the file has " +
                                std::to_string(size_ - offset) + " left");
    }
    content.resize(length);
    in_.read(content.data(), static_cast<std::streamsize>(length));
    if (!in_) place_.refuse(offset, "cannot be read: " + std::string(std::strerror(errno)));
    if (opcode == Opcode::footer) return true;
    record(opcode, offset, content);
    offset += length;
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
      return message(fields);
    case Opcode::chunk:
      return chunk(fields);
    case Opcode::metadata: {
      Fields metadata = fields;
      const std::string name(metadata.text());
      if (visitor_.metadata) visitor_.metadata(name, metadata.map());
      return;
    }
    default:
      return;  // indexes, attachments, and additions of later versions
  }
}

void Reader::schema(Fields fields) {
  Schema schema;
  schema.id = fields.number<std::uint16_t>();
  schema.name = fields.text();
  schema.encoding = fields.text();
  schema.data = fields.text();
  schemas_[schema.id] = std::move(schema);
}

void Reader::channel(Fields fields) {
  Channel channel;
  channel.id = fields.number<std::uint16_t>();
  channel.schema_id = fields.number<std::uint16_t>();
  channel.topic = fields.text();
  channel.encoding = fields.text();
  channels_[channel.id] = std::move(channel);
}

void Reader::message(Fields fields) {
  Message message;
  message.offset = fields.offset();
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

void Reader::chunk(Fields fields) {
  const std::uint64_t start = fields.offset();
  fields.number<std::uint64_t>();  // earliest and latest log time
  fields.number<std::uint64_t>();
  fields.number<std::uint64_t>();  // uncompressed size
  const auto crc = fields.number<std::uint32_t>();
  const std::string compression(fields.text());
  if (!compression.empty()) {
    place_.refuse(start,
                  "a chunk compressed with '" + compression +
                      "'; only uncompressed chunks are accepted ('mcap compress --compression none' makes them)");
  }
  const auto length = fields.number<std::uint64_t>();
  const std::uint64_t offset = fields.offset();
  const std::string_view records = fields.take(length);
  const auto actual =
      static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size()));
  if (crc != 0 && crc != actual) {
    char text[96];
    std::snprintf(text, sizeof text, "the chunk is damaged: its CRC-32 is 0x%08x, the file says 0x%08x", actual, crc);
    place_.refuse(start, text);
  }
  Fields inner(place_, offset, records);
  while (!inner.rest().empty()) {
    const Opcode opcode{inner.number<std::uint8_t>()};
    const auto size = inner.number<std::uint64_t>();
    const std::uint64_t at = inner.offset();
    const std::string_view content = inner.take(size);
    if (opcode == Opcode::chunk) place_.refuse(at, "a chunk within a chunk");
    record(opcode, at, content);
  }
}

}  // namespace

bool read(std::istream& in, const std::string& name, const Visitor& visitor) { return Reader(in, name, visitor).run(); }

}  // namespace forcebound::record::mcap
