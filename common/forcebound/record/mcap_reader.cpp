#include "forcebound/record/mcap_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "forcebound/record/internal/mcap_chunk.hpp"
#include "forcebound/record/internal/mcap_fields.hpp"
#include "forcebound/record/internal/mcap_index.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::record::mcap {
namespace {

class Reader {
 public:
  Reader(std::istream& in, const std::string& name, const Visitor& visitor) : in_(in), file_(name), visitor_(visitor) {}

  Ending run();

 private:
  /// A record that begins at `begin`, by what its own head says or the index.
  struct Head {
    std::uint64_t begin = 0;
    Opcode opcode = Opcode::none;
    std::uint64_t length = 0;
  };

  void measure();
  std::optional<Head> next_head();
  Head as_indexed(Head stated);
  bool is_readable(const Head& head);
  bool go_on(const Head& unreadable);
  std::string content_of(const Head& head);
  void check_all(const Head& data_end, std::string_view content);
  void count_damage(const std::string& what);
  template <class Call>
  void attempt(std::uint64_t offset, const Call& call);

  void record(Opcode opcode, std::uint64_t offset, std::string_view content);
  void message(Fields fields, std::uint64_t offset);
  void metadata(Fields fields, std::uint64_t offset);
  void attachment(Fields fields);
  void chunk(Fields fields);
  void cut_chunk(Fields fields);
  void visit(const ChunkRecords& records, bool cut);

  [[noreturn]] void refuse(std::uint64_t byte, const std::string& what) const {
    throw std::runtime_error(file_ + ": byte " + std::to_string(byte) + ": " + what);
  }

  std::istream& in_;
  const std::string& file_;
  const Visitor& visitor_;
  Ending ending_;
  bool ended_ = false;  ///< the file's last bytes are those of a complete one
  std::optional<FileIndex> index_;
  std::string head_bytes_;  ///< of the record that is read
  std::uint32_t crc_ = 0;   ///< of all bytes before it, unless some were passed over, which is damage
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

void Reader::count_damage(const std::string& what) {
  if (ending_.damaged++ == 0) ending_.damage = what;
  if (visitor_.damage) visitor_.damage(what);
}

/// Counts it as damage where a record, or for a visitor its content, is not as it should be.
template <class Call>
void Reader::attempt(std::uint64_t offset, const Call& call) {
  try {
    call();
  } catch (const Damage& damage) {
    count_damage(damage.what());
  } catch (const std::invalid_argument& error) {
    count_damage(Damage(offset, error.what()).what());
  }
}

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
  const std::string wrong = "the magic bytes at its start are missing";
  if (!in_ || (magic != kMagic && !ended_)) refuse(0, "not an MCAP file of version 0: " + wrong);
  if (magic != kMagic) count_damage(Damage(0, wrong).what());
  if (ended_) attempt(ending_.size, [this] { index_ = read_index(in_, ending_.size); });
  if (index_) {
    schemas_ = index_->schemas;
    channels_ = index_->channels;
    ending_.messages_stated = index_->messages.value_or(0);
  }
  crc_ = crc32_of(magic);
  ending_.whole = kMagic.size();
}

/// The head of the record behind all that is whole so far; nothing: there is none.
std::optional<Reader::Head> Reader::next_head() {
  const std::uint64_t begin = ending_.whole;
  if (index_ && begin >= index_->end) {
    ending_.complete = true;
    ending_.whole = ending_.size - kMagic.size();
    return std::nullopt;
  }
  // What a run still writes meanwhile is left out.
  if (ending_.size - begin < kRecordHeaderBytes) return std::nullopt;
  head_bytes_.resize(kRecordHeaderBytes);
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(begin));
  in_.read(head_bytes_.data(), static_cast<std::streamsize>(head_bytes_.size()));
  if (!in_) return std::nullopt;
  Fields fields(begin, head_bytes_);
  Head head{.begin = begin, .opcode = Opcode{fields.number<std::uint8_t>()}};
  head.length = fields.number<std::uint64_t>();
  return index_ ? as_indexed(head) : head;
}

Reader::Head Reader::as_indexed(Head stated) {
  const auto known = index_->places.find(stated.begin);
  if (known == index_->places.end()) return stated;
  const auto& [opcode, length, name] = known->second;
  if (stated.opcode == opcode && stated.length == length) return stated;
  count_damage(Damage(stated.begin, "the head of the " + std::string(name_of(opcode)) + " is damaged").what());
  return {stated.begin, opcode, length};
}

/// Whether all of it is within the file, and nothing that the index has is within it.
bool Reader::is_readable(const Head& head) {
  if (head.opcode == Opcode::none) return false;
  std::uint64_t limit = ending_.size;
  if (index_) {
    const auto next = index_->places.upper_bound(head.begin);
    limit = next == index_->places.end() ? index_->end : next->first;
  }
  return head.length <= limit - std::min(limit, head.begin + kRecordHeaderBytes);
}

/// Behind a record whose end is not known, at the next one that is. False: the file ends there.
bool Reader::go_on(const Head& unreadable) {
  const std::uint64_t offset = unreadable.begin + kRecordHeaderBytes;
  const std::uint64_t left = ending_.size - offset;
  const std::string what = unreadable.opcode == Opcode::none
                               ? "a record of kind 0, which there is not"
                               : "a record of " + std::to_string(unreadable.length) + " bytes, where the file has " +
                                     std::to_string(left) + " left";
  if (index_) {
    count_damage(Damage(offset, what).what());
    const auto next = index_->places.upper_bound(unreadable.begin);
    ending_.whole = next == index_->places.end() ? index_->end : next->first;
    return true;
  }
  if (ended_ && ending_.only_index_is_lost) {
    // Its damage is counted; what it is about has been read.
    ending_.complete = true;
    ending_.whole = ending_.size - kMagic.size();
    return false;
  }
  const std::string rest = content_of({unreadable.begin, unreadable.opcode, left});
  if (const auto found = find_records(rest)) {
    count_damage(Damage(offset, what).what());
    ending_.whole = offset + *found;
    return true;
  }
  if (ended_) {
    count_damage(Damage(offset, what).what());
  } else {
    ending_.kind = name_of(unreadable.opcode);
    ending_.declared = unreadable.length;
    if (unreadable.opcode == Opcode::chunk) attempt(offset, [&] { cut_chunk({offset, rest}); });
  }
  return false;
}

std::string Reader::content_of(const Head& head) {
  std::string content(head.length, '\0');
  in_.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (!in_) refuse(head.begin + kRecordHeaderBytes, "cannot be read: " + std::string(std::strerror(errno)));
  return content;
}

/// The checksum over all records covers what none of its own does: metadata, and heads of records.
void Reader::check_all(const Head& data_end, std::string_view content) {
  ending_.only_index_is_lost = true;
  if (ending_.damaged > 0) return;
  const std::uint64_t offset = data_end.begin + kRecordHeaderBytes;
  const auto stated = Fields(offset, content).number<std::uint32_t>();
  if (stated == 0 || stated == crc_) return;
  throw Damage(offset,
               "the checksum of all records is wrong, though no chunk's is: settings, totals or an index are damaged");
}

Ending Reader::run() {
  measure();
  while (const std::optional<Head> head = next_head()) {
    if (!is_readable(*head)) {
      if (go_on(*head)) continue;
      break;
    }
    const std::uint64_t offset = head->begin + kRecordHeaderBytes;
    if (head->opcode == Opcode::footer) {
      ending_.complete = ended_;
      ending_.whole = offset + head->length;
      break;
    }
    const std::string content = content_of(*head);
    attempt(offset, [&] {
      if (head->opcode == Opcode::data_end) {
        check_all(*head, content);
      } else if (!ending_.only_index_is_lost) {  // behind it all is said a second time
        record(head->opcode, offset, content);
      }
    });
    crc_ = crc32_of(content, crc32_of(head_bytes_, crc_));
    ending_.whole = offset + head->length;
  }
  return ending_;
}

void Reader::record(Opcode opcode, std::uint64_t offset, std::string_view content) {
  const Fields fields(offset, content);
  switch (opcode) {
    case Opcode::schema: {
      Schema schema = schema_in(offset, content);
      schemas_.emplace(schema.id, std::move(schema));
      return;
    }
    case Opcode::channel: {
      Channel channel = channel_in(offset, content);
      channels_.emplace(channel.id, std::move(channel));
      return;
    }
    case Opcode::message:
      return message(fields, offset);
    case Opcode::chunk:
      return chunk(fields);
    case Opcode::attachment:
      return attachment(fields);
    case Opcode::metadata:
      return metadata(fields, offset);
    default:
      return;  // indexes, and additions of later versions
  }
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
    throw Damage(offset, "a message of channel " + std::to_string(id) + ", which was not declared before it");
  }
  const Schema none;
  const auto schema = schemas_.find(channel->second.schema_id);
  if (visitor_.message) visitor_.message(schema == schemas_.end() ? none : schema->second, channel->second, message);
  ++ending_.messages;
}

void Reader::metadata(Fields fields, std::uint64_t offset) {
  std::string name(fields.text());
  if (index_) {
    const auto place = index_->places.find(offset - kRecordHeaderBytes);
    if (place != index_->places.end()) name = place->second.name;
  }
  if (visitor_.metadata) visitor_.metadata(name, fields.map());
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

void Reader::chunk(Fields fields) {
  const ChunkRecords records = records_in(fields, file_);
  ending_.stored += records.stored.size();
  ending_.uncompressed += records.bytes().size();
  visit(records, false);
}

/// Visits what is whole at the beginning of a chunk that the file's end cuts off.
void Reader::cut_chunk(Fields fields) {
  const std::uint64_t messages_before = ending_.messages;
  visit(records_in_cut(fields, file_), true);
  ending_.rescued = ending_.messages - messages_before;
}

/// @param cut the last record may be cut off; else that is damage
void Reader::visit(const ChunkRecords& records, bool cut) {
  Fields inner(records.offset, records.bytes());
  while (!inner.rest().empty()) {
    if (cut && inner.rest().size() < kRecordHeaderBytes) return;
    const Opcode opcode{inner.number<std::uint8_t>()};
    const auto size = inner.number<std::uint64_t>();
    const std::uint64_t at = records.compressed ? records.offset : inner.offset();
    if (cut && size > inner.rest().size()) return;
    const std::string_view content = inner.take(size);
    if (opcode == Opcode::chunk) throw Damage(at, "a chunk within a chunk");
    if (opcode == Opcode::none) throw Damage(at, "a record of kind 0, which there is not");
    attempt(at, [&] { record(opcode, at, content); });
  }
}

std::string damage_in_words(const Ending& ending) {
  std::string words = text::counted(ending.damaged, "damaged record");
  if (ending.messages < ending.messages_stated) {
    words += ", with " + std::to_string(ending.messages_stated - ending.messages) + " of " +
             text::counted(ending.messages_stated, "message");
  }
  return words + (ending.damaged > 1 ? " (the first at " : " (at ") + ending.damage + ")";
}

std::string end_in_words(const Ending& ending) {
  std::string words = "it ends at byte " + std::to_string(ending.size);
  if (ending.only_index_is_lost) return words + ", within the index behind its last record: all records are there";
  if (ending.whole == ending.size) return words + ", behind a whole record";
  if (ending.kind.empty()) return words + "; from byte " + std::to_string(ending.whole) + " on it has no whole record";
  words += ", within a " + ending.kind + " of " + std::to_string(ending.declared) + " bytes that begins at byte " +
           std::to_string(ending.whole);
  if (ending.rescued > 0) words += ", of which the first " + std::to_string(ending.rescued) + " messages are whole";
  return words;
}

}  // namespace

std::string in_words(const Ending& ending) {
  std::string words = ending.damaged > 0 ? damage_in_words(ending) : std::string();
  if (ending.complete) return words;
  return words + (words.empty() ? "" : "; ") + end_in_words(ending);
}

Ending read(std::istream& in, const std::string& name, const Visitor& visitor) {
  return Reader(in, name, visitor).run();
}

}  // namespace forcebound::record::mcap
