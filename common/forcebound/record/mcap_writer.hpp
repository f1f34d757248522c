#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/record/mcap_format.hpp"

namespace forcebound::record::mcap {

class Compressor;

/// Writes an indexed MCAP file with CRC-32 over chunks, attachments, data and summary; chunks are compressed with zstd
/// unless another is said, or where that makes them no smaller.
///
/// Messages are collected in chunks of up to one second of log time (or 4 MB), each handed to the stream and flushed
/// when it is full. The first write that fails ends the file there: everything before is readable, everything after is
/// counted.
///
/// Allocates and blocks. Not thread-safe.
class Writer {
 public:
  /// @param out must outlive the writer; writing starts at its present position, taken as offset 0.
  Writer(std::ostream& out, std::string_view library, Compression compression = Compression::zstd);
  ~Writer();

  /// Declares a topic whose messages are of one schema; returns the channel's number. Topics may share a schema of one
  /// name.
  std::uint16_t add_channel(std::string_view topic, std::string_view schema_name, std::string_view schema_encoding,
                            std::string_view schema, std::string_view message_encoding);

  void add_metadata(std::string_view name, const std::map<std::string, std::string>& values);

  /// A file within the file, for people and other programs.
  void add_attachment(std::string_view name, std::string_view media_type, std::uint64_t log_time,
                      std::string_view data);

  /// @param log_time nanoseconds since 1970; need not be in order.
  void write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t log_time, std::string_view data);

  /// Ends the chunk and hands it to the operating system.
  void flush();

  /// Flushes and writes the index. Nothing can be written afterwards.
  void close();

  /// The system's number (errno) of the write that failed; 0 if none did.
  [[nodiscard]] int error() const noexcept { return error_; }
  [[nodiscard]] bool failed() const noexcept { return error_ != 0; }

  /// Messages of a channel that did not reach the stream.
  [[nodiscard]] std::uint64_t unwritten(std::uint16_t channel) const noexcept;

  /// Messages that did.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }

 private:
  struct Entry {
    std::uint64_t log_time;
    std::uint64_t offset;
  };
  struct Chunk {
    std::string records;
    std::uint64_t messages = 0;
    std::uint64_t start = 0;
    std::uint64_t end = 0;
    std::map<std::uint16_t, std::vector<Entry>> index;
  };

  /// A chunk as it was written.
  struct Stored {
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;  ///< of the record
    std::string_view compression;
    std::uint64_t records_bytes = 0;
  };

  bool emit(std::string_view bytes);
  void index_chunk(const Stored& stored, const std::map<std::uint16_t, std::uint64_t>& index_offsets,
                   std::uint64_t index_bytes);
  [[nodiscard]] std::string statistics() const;

  std::ostream& out_;
  int error_ = 0;
  bool closed_ = false;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;
  std::uint64_t written_ = 0;
  std::map<std::uint16_t, std::uint64_t> unwritten_;
  Chunk chunk_;
  std::unique_ptr<Compressor> compressor_;  // null: nothing is compressed

  // Records of the summary section.
  std::string schemas_, channels_, chunk_indexes_, attachment_indexes_, metadata_indexes_;
  std::map<std::string, std::uint16_t, std::less<>> schema_ids_;
  std::uint16_t channel_count_ = 0;
  std::uint32_t chunk_count_ = 0;
  std::uint32_t attachment_count_ = 0;
  std::uint32_t metadata_count_ = 0;
  std::uint64_t start_ = 0;
  std::uint64_t end_ = 0;
  std::map<std::uint16_t, std::uint64_t> message_counts_;
};

}  // namespace forcebound::record::mcap
