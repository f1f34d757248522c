#include "forcebound/record/mcap_writer.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <utility>

#include "forcebound/record/internal/mcap_fields.hpp"
#include "forcebound/record/internal/zstd.hpp"

namespace forcebound::record::mcap {
namespace {

constexpr std::uint64_t kChunkNanoseconds = 1'000'000'000;
constexpr std::size_t kChunkBytes = std::size_t{4} << 20;

}  // namespace

Writer::Writer(std::ostream& out, std::string_view library, Compression compression)
    : out_(out), compressor_(compression == Compression::zstd ? std::make_unique<Compressor>() : nullptr) {
  std::string begin(kMagic);
  std::string header;
  put(header, std::string_view{});  // no profile
  put(header, library);
  put_record(begin, Opcode::header, header);
  emit(begin);
  chunk_.records.reserve(kChunkBytes + kChunkBytes / 8);
}

Writer::~Writer() = default;

bool Writer::emit(std::string_view bytes) {
  if (failed()) return false;
  errno = 0;
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out_.flush();
  if (!out_) error_ = errno != 0 ? errno : EIO;
  offset_ += bytes.size();
  crc_ = crc32_of(bytes, crc_);
  return !failed();
}

std::uint16_t Writer::add_channel(std::string_view topic, std::string_view schema_name,
                                  std::string_view schema_encoding, std::string_view schema,
                                  std::string_view message_encoding) {
  const std::size_t schemas_before = schemas_.size();
  const std::size_t channels_before = channels_.size();
  std::string content;
  auto known = schema_ids_.find(schema_name);
  if (known == schema_ids_.end()) {
    known = schema_ids_.emplace(schema_name, static_cast<std::uint16_t>(schema_ids_.size() + 1)).first;
    put(content, known->second);
    put(content, schema_name);
    put(content, schema_encoding);
    put(content, schema);
    put_record(schemas_, Opcode::schema, content);
  }

  content.clear();
  put(content, ++channel_count_);
  put(content, known->second);
  put(content, topic);
  put(content, message_encoding);
  put(content, std::map<std::string, std::string>{});
  put_record(channels_, Opcode::channel, content);

  // In the chunk as well, so that a file without its end can be read.
  chunk_.records.append(schemas_, schemas_before);
  chunk_.records.append(channels_, channels_before);
  return channel_count_;
}

void Writer::add_metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  flush();
  std::string content;
  put(content, name);
  put(content, values);
  std::string record;
  put_record(record, Opcode::metadata, content);

  content.clear();
  put(content, offset_);
  put(content, static_cast<std::uint64_t>(record.size()));
  put(content, name);
  if (!emit(record)) return;
  put_record(metadata_indexes_, Opcode::metadata_index, content);
  ++metadata_count_;
}

void Writer::add_attachment(std::string_view name, std::string_view media_type, std::uint64_t log_time,
                            std::string_view data) {
  flush();
  std::string content;
  put(content, log_time);
  put(content, log_time);  // created when it was logged
  put(content, name);
  put(content, media_type);
  put(content, static_cast<std::uint64_t>(data.size()));
  content += data;
  put(content, crc32_of(content));
  std::string record;
  put_record(record, Opcode::attachment, content);

  content.clear();
  put(content, offset_);
  put(content, static_cast<std::uint64_t>(record.size()));
  put(content, log_time);
  put(content, log_time);
  put(content, static_cast<std::uint64_t>(data.size()));
  put(content, name);
  put(content, media_type);
  if (!emit(record)) return;
  put_record(attachment_indexes_, Opcode::attachment_index, content);
  ++attachment_count_;
}

void Writer::write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t log_time, std::string_view data) {
  if (failed() || closed_) {
    ++unwritten_[channel];
    return;
  }
  const bool full = chunk_.messages != 0 &&
                    (log_time >= chunk_.start + kChunkNanoseconds || chunk_.records.size() + data.size() > kChunkBytes);
  if (full) flush();
  chunk_.index[channel].push_back({log_time, chunk_.records.size()});
  chunk_.start = chunk_.messages == 0 ? log_time : std::min(chunk_.start, log_time);
  chunk_.end = chunk_.messages == 0 ? log_time : std::max(chunk_.end, log_time);
  ++chunk_.messages;

  constexpr std::size_t kFixed = 2 + 4 + 8 + 8;
  chunk_.records += static_cast<char>(Opcode::message);
  put(chunk_.records, static_cast<std::uint64_t>(kFixed + data.size()));
  put(chunk_.records, channel);
  put(chunk_.records, sequence);
  put(chunk_.records, log_time);
  put(chunk_.records, log_time);  // published when it was logged
  chunk_.records += data;
}

std::uint64_t Writer::unwritten(std::uint16_t channel) const noexcept {
  const auto found = unwritten_.find(channel);
  return found == unwritten_.end() ? 0 : found->second;
}

void Writer::flush() {
  if (chunk_.records.empty()) return;
  const std::optional<std::string_view> compressed =
      compressor_ ? compressor_->compress(chunk_.records) : std::optional<std::string_view>();
  const std::string_view records = compressed.value_or(chunk_.records);
  Stored stored{.offset = offset_, .compression = compressed ? "zstd" : "", .records_bytes = records.size()};
  std::string content;
  put(content, chunk_.start);
  put(content, chunk_.end);
  put(content, static_cast<std::uint64_t>(chunk_.records.size()));
  put(content, crc32_of(chunk_.records));
  put(content, stored.compression);
  put(content, stored.records_bytes);
  content += records;
  std::string out;
  put_record(out, Opcode::chunk, content);
  stored.bytes = out.size();

  std::map<std::uint16_t, std::uint64_t> index_offsets;
  for (const auto& [channel, entries] : chunk_.index) {
    index_offsets[channel] = stored.offset + out.size();
    content.clear();
    put(content, channel);
    put(content, static_cast<std::uint32_t>(entries.size() * 2 * sizeof(std::uint64_t)));
    for (const Entry& entry : entries) {
      put(content, entry.log_time);
      put(content, entry.offset);
    }
    put_record(out, Opcode::message_index, content);
  }
  if (emit(out)) {
    index_chunk(stored, index_offsets, out.size() - stored.bytes);
  } else {
    for (const auto& [channel, entries] : chunk_.index) unwritten_[channel] += entries.size();
  }
  chunk_.records.clear();
  chunk_.index.clear();
  chunk_.messages = chunk_.start = chunk_.end = 0;
}

void Writer::index_chunk(const Stored& stored, const std::map<std::uint16_t, std::uint64_t>& index_offsets,
                         std::uint64_t index_bytes) {
  std::string content;
  put(content, chunk_.start);
  put(content, chunk_.end);
  put(content, stored.offset);
  put(content, stored.bytes);
  put(content, static_cast<std::uint32_t>(index_offsets.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
  for (const auto& [channel, at] : index_offsets) {
    put(content, channel);
    put(content, at);
  }
  put(content, index_bytes);
  put(content, stored.compression);
  put(content, stored.records_bytes);
  put(content, static_cast<std::uint64_t>(chunk_.records.size()));
  put_record(chunk_indexes_, Opcode::chunk_index, content);

  if (chunk_.messages != 0) {
    start_ = written_ == 0 ? chunk_.start : std::min(start_, chunk_.start);
    end_ = std::max(end_, chunk_.end);
  }
  for (const auto& [channel, entries] : chunk_.index) message_counts_[channel] += entries.size();
  written_ += chunk_.messages;
  ++chunk_count_;
}

std::string Writer::statistics() const {
  std::string content;
  put(content, written_);
  put(content, static_cast<std::uint16_t>(schema_ids_.size()));
  put(content, std::uint32_t{channel_count_});
  put(content, attachment_count_);
  put(content, metadata_count_);
  put(content, chunk_count_);
  put(content, start_);
  put(content, end_);
  put(content, static_cast<std::uint32_t>(message_counts_.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
  for (const auto& [channel, count] : message_counts_) {
    put(content, channel);
    put(content, count);
  }
  std::string record;
  put_record(record, Opcode::statistics, content);
  return record;
}

void Writer::close() {
  if (closed_) return;
  flush();
  closed_ = true;
  std::string content;
  put(content, crc_);
  std::string out;
  put_record(out, Opcode::data_end, content);
  if (!emit(out)) return;

  const std::uint64_t summary_start = offset_;
  const std::array<std::pair<Opcode, std::string>, 6> groups{{{Opcode::schema, schemas_},
                                                              {Opcode::channel, channels_},
                                                              {Opcode::chunk_index, chunk_indexes_},
                                                              {Opcode::attachment_index, attachment_indexes_},
                                                              {Opcode::metadata_index, metadata_indexes_},
                                                              {Opcode::statistics, statistics()}}};
  std::string summary;
  std::string offsets;
  for (const auto& [opcode, records] : groups) {
    if (records.empty()) continue;
    content.clear();
    content += static_cast<char>(opcode);
    put(content, summary_start + summary.size());
    put(content, static_cast<std::uint64_t>(records.size()));
    put_record(offsets, Opcode::summary_offset, content);
    summary += records;
  }
  const std::uint64_t offsets_start = summary_start + summary.size();
  summary += offsets;

  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  summary += static_cast<char>(Opcode::footer);
  put(summary, kFooterBytes);
  put(summary, summary_start);
  put(summary, offsets_start);
  put(summary, crc32_of(summary));
  summary += kMagic;
  emit(summary);
}

}  // namespace forcebound::record::mcap
