#pragma once

#include <array>
#include <cstdint>

#include "forcebound/control/enum_array.hpp"

namespace forcebound::wire {

/// Why a datagram was dropped. Each reason is counted.
enum class Malformed : std::uint8_t {
  oversize,    ///< longer than the protocol allows
  truncated,   ///< shorter than the frame's header
  foreign,     ///< without the protocol's mark, or of another frame version
  corrupt,     ///< the checksum disagrees
  unreadable,  ///< the body is not the message of its kind; also a short Hello, or a motion without position
  non_finite,  ///< a number in it is not finite, a vector has more than six rows or more than 16 numbers of a
               ///< server-side law
};

/// What is said and counted of a reason.
struct MalformedRow {
  Malformed reason;
  const char* name;  ///< of its counter, after "malformed_"
  const char* word;  ///< of such datagrams, among others
  const char* one;   ///< what a client's summary counts
  const char* many;
};

inline constexpr std::array kMalformed{
    MalformedRow{Malformed::oversize, "oversize", "oversize", "datagram longer than the protocol allows",
                 "datagrams longer than the protocol allows"},
    MalformedRow{Malformed::truncated, "truncated", "truncated", "datagram shorter than a frame header",
                 "datagrams shorter than a frame header"},
    MalformedRow{Malformed::foreign, "foreign", "foreign", "datagram that is not ours, or of another version",
                 "datagrams that are not ours, or of another version"},
    MalformedRow{Malformed::corrupt, "corrupt", "corrupt", "datagram whose checksum disagrees",
                 "datagrams whose checksum disagrees"},
    MalformedRow{Malformed::unreadable, "unreadable", "unreadable", "datagram whose body cannot be read",
                 "datagrams whose body cannot be read"},
    MalformedRow{Malformed::non_finite, "non_finite", "not finite", "datagram with numbers that are not finite",
                 "datagrams with numbers that are not finite"},
};

static_assert(control::is_in_order(kMalformed, &MalformedRow::reason));
using MalformedCounts = control::EnumArray<Malformed, std::uint64_t, kMalformed.size()>;

}  // namespace forcebound::wire
