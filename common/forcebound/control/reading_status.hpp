#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

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
static_assert([] {
  for (std::size_t i = 0; i < kReadingStatuses.size(); ++i) {
    if (static_cast<std::size_t>(kReadingStatuses[i].status) != i) return false;
  }
  return true;
}());

[[nodiscard]] constexpr std::string_view why(ReadingStatus status) noexcept {
  return kReadingStatuses[static_cast<std::size_t>(status)].why;
}

/// How many readings there were of each status.
class ReadingCounts {
 public:
  [[nodiscard]] constexpr std::uint64_t& operator[](ReadingStatus status) noexcept {
    return counts_[static_cast<std::size_t>(status)];
  }
  [[nodiscard]] constexpr std::uint64_t operator[](ReadingStatus status) const noexcept {
    return counts_[static_cast<std::size_t>(status)];
  }
  /// Of all but `ok`.
  [[nodiscard]] constexpr std::uint64_t refused() const noexcept {
    std::uint64_t sum = 0;
    for (std::size_t i = 1; i < counts_.size(); ++i) sum += counts_[i];
    return sum;
  }

 private:
  std::array<std::uint64_t, kReadingStatuses.size()> counts_{};
};

}  // namespace forcebound::control
