#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/record/mcap_format.hpp"

/// Where the records of a file are, also where one of them is damaged. Private to this folder.
namespace forcebound::record::mcap {

/// A record without its opcode and length.
struct RecordPlace {
  Opcode opcode = Opcode::none;
  std::uint64_t length = 0;
  std::string name{};  ///< of metadata
};

/// What the end of a file says about it: the schemas and channels again, and where chunks, metadata and attachments
/// are.
struct FileIndex {
  std::map<std::uint16_t, Schema> schemas{};
  std::map<std::uint16_t, Channel> channels{};
  std::map<std::uint64_t, RecordPlace> places{};  ///< by the byte at which the record begins
  std::uint64_t end = 0;                          ///< of the records that it is about: where it begins itself
  std::optional<std::uint64_t> messages{};        ///< in all of the file
};

/// @throws Damage if a name is longer than is kept
[[nodiscard]] Schema schema_in(std::uint64_t offset, std::string_view content);
[[nodiscard]] Channel channel_in(std::uint64_t offset, std::string_view content);

/// The index of a file that ends as it should. Nothing: it has none, or none with a checksum.
/// @param size of the file
/// @throws Damage if its checksum is wrong.
[[nodiscard]] std::optional<FileIndex> read_index(std::istream& in, std::uint64_t size);

/// For a file without an index: where in `bytes` records go on that are as a file's are, several behind each other or
/// up to its end. None of those that may be within a chunk is taken for one.
[[nodiscard]] std::optional<std::size_t> find_records(std::string_view bytes);

}  // namespace forcebound::record::mcap
