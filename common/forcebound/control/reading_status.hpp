#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string_view>

#include "forcebound/control/enum_array.hpp"

namespace forcebound::control {

/// Whether a reading of a device can be used; each other value is the reason why it is refused.
enum class ReadingStatus : std::uint8_t {
  ok,
  stale,           ///< encoder values of an earlier reading
  failed,          ///< the device returned no reading, as where it is unplugged
  backwards,       ///< latched before the one that came before it
  future,          ///< latched after it was read
  incomplete,      ///< numbers that are not finite, or that are missing
  no_orientation,  ///< of a device that shows torques
};

/// What is said and counted of a status.
struct ReadingStatusRow {
  ReadingStatus status;
  const char* name;  ///< of its counter, after "refused_"
  const char* why;   ///< of the device, to its user
  const char* one;   ///< what the summary counts
  const char* many;
};

inline constexpr std::array kReadingStatuses{
    ReadingStatusRow{ReadingStatus::ok, "ok", "it can be used", "reading", "readings"},
    ReadingStatusRow{ReadingStatus::stale, "stale", "none of its readings is new",
                     "tick for which too long no reading was new: no force",
                     "ticks for which too long no reading was new: no force"},
    ReadingStatusRow{ReadingStatus::failed, "failed", "it gives no reading", "failed device reading: no force",
                     "failed device readings: no force"},
    ReadingStatusRow{ReadingStatus::backwards, "backwards", "its readings run backwards in time",
                     "reading that ran backwards in time: no force", "readings that ran backwards in time: no force"},
    ReadingStatusRow{ReadingStatus::future, "future", "its reading was latched in the future",
                     "reading latched in the future: no force", "readings latched in the future: no force"},
    ReadingStatusRow{ReadingStatus::incomplete, "incomplete", "its reading has numbers that are not finite",
                     "reading with numbers that are not finite: no force",
                     "readings with numbers that are not finite: no force"},
    ReadingStatusRow{ReadingStatus::no_orientation, "no_orientation",
                     "its reading has no orientation, which a device that shows torques must tell",
                     "reading without the orientation: no force", "readings without the orientation: no force"},
};
static_assert(is_in_order(kReadingStatuses, &ReadingStatusRow::status));

[[nodiscard]] constexpr std::string_view why(ReadingStatus status) noexcept {
  return kReadingStatuses[static_cast<std::size_t>(status)].why;
}

/// How many readings there were of each status.
using ReadingCounts = EnumArray<ReadingStatus, std::uint64_t, kReadingStatuses.size()>;

/// Those of each status but `ok`.
[[nodiscard]] constexpr std::uint64_t refused(const ReadingCounts& counts) noexcept {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}) - counts[ReadingStatus::ok];
}

}  // namespace forcebound::control
