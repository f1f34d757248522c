#pragma once

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
  std::string_view data;     ///< valid during the call
  std::uint64_t offset = 0;  ///< in the file, for error messages
};

/// Called with what a file holds, in file order.
struct Visitor {
  std::function<void(const Schema&, const Channel&, const Message&)> message;
  std::function<void(const std::string& name, const std::map<std::string, std::string>& values)> metadata;
};

/// Reads an MCAP file from its beginning, without its index, so that the file of a killed process can be read too.
///
/// @param name of the file, for error messages.
/// @returns whether the file is complete; false when it ends in the middle of a record, or without its end record. What
/// lies before was visited.
/// @throws std::runtime_error naming file, byte, what is wrong and what would be accepted: not an MCAP file, a checksum
/// that disagrees, lengths that contradict each other, a compressed chunk. Whatever the visitor throws passes through.
bool read(std::istream& in, const std::string& name, const Visitor& visitor);

}  // namespace forcebound::record::mcap
