#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "forcebound/record/internal/mcap_fields.hpp"

/// Chunks of an MCAP file, opened. Private to this folder.
namespace forcebound::record::mcap {

/// The records within a chunk.
struct ChunkRecords {
  std::uint64_t offset = 0;   ///< of the records in the file, or where they are compressed that of their chunk
  std::string_view stored{};  ///< as they are in the file: valid as long as the chunk's content
  bool compressed = false;
  std::string decompressed{};

  [[nodiscard]] std::string_view bytes() const noexcept { return compressed ? decompressed : stored; }
};

/// The records of a chunk that is whole.
/// @param content of the chunk @param file its name, for errors
/// @throws Damage where it is not as its head and checksum say; std::runtime_error with file, byte and what would be
/// accepted for a compression other than zstd
[[nodiscard]] ChunkRecords records_in(Fields content, const std::string& file);

/// What there is of the records of a chunk that the file's end cuts off; the last may be cut off too. No checksum
/// covers them. Throws as records_in does.
[[nodiscard]] ChunkRecords records_in_cut(Fields content, const std::string& file);

}  // namespace forcebound::record::mcap
