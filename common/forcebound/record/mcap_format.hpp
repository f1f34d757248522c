#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

/// The MCAP container format, version 0, as https://mcap.dev/spec has it: little-endian records <opcode, length,
/// content> between two magics.
namespace forcebound::record::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::size_t kRecordHeaderBytes = 9;

/// A compressed chunk that says that it holds more is refused before memory is taken for it.
inline constexpr std::size_t kChunkBytesMost = std::size_t{64} << 20U;

enum class Opcode : std::uint8_t {
  none = 0x00,  ///< not one: a file that lost power may end in zeros
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0a,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

/// As the specification calls it; empty: a kind that it does not have.
[[nodiscard]] constexpr std::string_view name_of(Opcode opcode) noexcept {
  constexpr std::array<std::string_view, 16> kNames{
      "",         "header",         "footer",         "schema",     "channel",          "message",
      "chunk",    "message index",  "chunk index",    "attachment", "attachment index", "statistics",
      "metadata", "metadata index", "summary offset", "data end"};
  const auto number = static_cast<std::size_t>(opcode);
  return number < kNames.size() ? kNames[number] : std::string_view();
}

enum class Compression : std::uint8_t { none, zstd };

struct Schema {
  std::uint16_t id = 0;
  std::string name;
  std::string encoding;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;
  std::string topic;
  std::string encoding;
};

/// Appends to a record's content.
template <std::unsigned_integral Number>
void put(std::string& out, Number value) {
  for (std::size_t i = 0; i < sizeof value; ++i) out += static_cast<char>(value >> (8 * i) & 0xffU);
}

inline void put(std::string& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

inline void put(std::string& out, const std::map<std::string, std::string>& map) {
  std::string entries;
  for (const auto& [key, value] : map) {
    put(entries, key);
    put(entries, value);
  }
  put(out, std::string_view(entries));
}

/// The whole record with that content.
inline void put_record(std::string& out, Opcode opcode, std::string_view content) {
  out += static_cast<char>(opcode);
  put(out, static_cast<std::uint64_t>(content.size()));
  out += content;
}

}  // namespace forcebound::record::mcap
