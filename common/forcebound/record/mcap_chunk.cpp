#include "forcebound/record/internal/mcap_chunk.hpp"

#include <stdexcept>
#include <utility>

#include "forcebound/record/internal/zstd.hpp"
#include "forcebound/record/mcap_format.hpp"

namespace forcebound::record::mcap {
namespace {

constexpr std::string_view kZstd = "zstd";
constexpr std::string_view kLz4 = "lz4";

/// A chunk's content apart from its records.
struct ChunkHead {
  std::uint64_t start = 0;  ///< byte of the chunk's content
  std::uint64_t size = 0;   ///< of the records, uncompressed
  std::uint32_t crc = 0;
  bool compressed = false;
  std::uint64_t stored = 0;  ///< bytes of the records in the file
};

ChunkHead take_head(Fields& fields, const std::string& file) {
  ChunkHead head{.start = fields.offset()};
  fields.number<std::uint64_t>();  // earliest and latest log time
  fields.number<std::uint64_t>();
  head.size = fields.number<std::uint64_t>();
  head.crc = fields.number<std::uint32_t>();
  const std::string_view compression = fields.text();
  head.compressed = !compression.empty();
  if (compression == kLz4) {
    throw std::runtime_error(file + ": byte " + std::to_string(head.start) +
                             ": a chunk compressed with 'lz4'; accepted are zstd and none ('mcap compress "
                             "--compression zstd' makes them)");
  }
  if (head.compressed && compression != kZstd) throw Damage(head.start, "a chunk with an unknown compression");
  if (head.compressed && head.size > kChunkBytesMost) {
    throw Damage(head.start, "a compressed chunk that would hold " + std::to_string(head.size) +
                                 " bytes; accepted are at most " + std::to_string(kChunkBytesMost));
  }
  head.stored = fields.number<std::uint64_t>();
  return head;
}

}  // namespace

ChunkRecords records_in(Fields content, const std::string& file) {
  const ChunkHead head = take_head(content, file);
  ChunkRecords records{.offset = head.compressed ? head.start : content.offset(), .compressed = head.compressed};
  records.stored = content.take(head.stored);
  if (head.compressed) {
    Decompressed decompressed = decompress(records.stored, head.size);
    if (!decompressed.problem.empty()) {
      throw Damage(head.start, "the compressed chunk is damaged: " + decompressed.problem);
    }
    if (decompressed.bytes.size() != head.size) {
      throw Damage(head.start, "a compressed chunk that holds " + std::to_string(decompressed.bytes.size()) +
                                   " bytes, where it says " + std::to_string(head.size));
    }
    records.decompressed = std::move(decompressed.bytes);
  }
  expect_crc(head.crc, records.bytes(), head.start, "chunk");
  return records;
}

ChunkRecords records_in_cut(Fields content, const std::string& file) {
  constexpr std::size_t kFixed = 8 + 8 + 8 + 4 + 4 + 8;  // with an empty name of the compression
  if (content.rest().size() < kFixed + kZstd.size()) return {};
  const ChunkHead head = take_head(content, file);
  if (head.compressed) {
    return {.offset = head.start,
            .stored = content.rest(),
            .compressed = true,
            .decompressed = decompress(content.rest(), head.size).bytes};
  }
  // Zeros after a loss of power may begin within a record, which is cut off there.
  const std::string_view stored = content.rest();
  return {.offset = content.offset(), .stored = stored.substr(0, stored.find_last_not_of('\0') + 1)};
}

}  // namespace forcebound::record::mcap
