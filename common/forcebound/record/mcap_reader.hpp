#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <istream>
#include <map>
#include <string>
#include <string_view>

#include "forcebound/record/mcap_format.hpp"

namespace forcebound::record::mcap {

struct Message {
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::string_view data;  ///< valid during the call
  /// In the file, for error messages; of a message in a compressed chunk, that chunk's.
  std::uint64_t offset = 0;
};

/// A file within the file.
struct Attachment {
  std::string name;
  std::string media_type;
  std::uint64_t log_time = 0;
  std::string_view data;  ///< valid during the call
};

/// Called with what a file holds, in file order. Where one throws std::invalid_argument, the record counts as damaged
/// and the rest goes on; whatever else it throws ends the reading.
struct Visitor {
  std::function<void(const Schema&, const Channel&, const Message&)> message{};
  std::function<void(const std::string& name, const std::map<std::string, std::string>& values)> metadata{};
  std::function<void(const Attachment&)> attachment{};
  /// Of each damaged record, what is wrong with it: "byte 17: the chunk is damaged: ...".
  std::function<void(const std::string& what)> damage{};
};

/// Where a file ends, and what is whole of it: all that was visited.
struct Ending {
  bool complete = false;              ///< it has its end
  std::uint64_t damaged = 0;          ///< records, left out of what was visited; a chunk is one
  std::string damage{};               ///< the first of them: "byte 17: the chunk is damaged: ..."
  std::uint64_t messages = 0;         ///< visited ...
  std::uint64_t messages_stated = 0;  ///< ... of those that the file says it has; 0: it does not say
  std::uint64_t size = 0;             ///< of the file [bytes]
  std::uint64_t whole = 0;            ///< of these, in records that are whole
  std::uint64_t declared = 0;         ///< bytes that the record which is cut off says it has; 0: not known
  std::string kind{};                 ///< of that record: "chunk"; empty: not known
  std::uint64_t rescued = 0;          ///< messages at the beginning of a chunk that is cut off, visited too
  bool only_index_is_lost = false;    ///< all data are whole
  std::uint64_t stored = 0;           ///< bytes of chunks, as they are in the file ...
  std::uint64_t uncompressed = 0;     ///< ... and without compression

  /// All is there and whole.
  explicit operator bool() const noexcept { return complete && damaged == 0; }
};

/// What is missing and what is not, with byte positions: "it ends at byte 18442, within a chunk of 12000 bytes that
/// begins at byte 9000, of which the first 150 messages are whole"; "1 damaged record, with 995 of 6213 messages (byte
/// 9009: the chunk is damaged: ...)". Empty: all is there and whole.
[[nodiscard]] std::string in_words(const Ending& ending);

/// Reads an MCAP file from its beginning, so that the file of a killed process can be read too. Chunks may be
/// compressed with zstd. All that is whole is visited: where the file ends within a chunk, the messages of that chunk
/// up to there, which no checksum covers then. What is damaged is left out and counted. Where a damaged record ends,
/// and what its topics were, the index at the file's end tells; without one, as in the file of a killed process, the
/// next bytes that look like records do.
///
/// @param name of the file, for error messages.
/// @returns whether all of the file is there and whole; it is not when it ends in the middle of a record, or without
/// its end record, or in zeros, as after a loss of power.
/// @throws std::runtime_error naming file, byte, what is wrong and what would be accepted: not an MCAP file, or a chunk
/// that is compressed by other means.
Ending read(std::istream& in, const std::string& name, const Visitor& visitor);

}  // namespace forcebound::record::mcap
