#pragma once

#include <limits>
#include <string>

#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {

/// A step shorter by less than this share of the server's own step [1 / session rate] makes no difference that a hand
/// could feel: it reduces the force's age by that.
inline constexpr double kTimeShareThatCounts = 0.01;

/// A recommended setting whose force points further aside than this at the 95th percentile is warned of [deg].
inline constexpr double kDirectionWarning_deg = 10;

/// Time saved per step.
struct TimeSaved {
  double us = 0;          ///< of the medians; < 0: it takes longer
  double counted_us = 0;  ///< savings below this do not count
  [[nodiscard]] bool counts() const noexcept { return us >= counted_us; }
};

/// What a setting saves over another one. It counts from kTimeShareThatCounts of the server's step on, if that is not
/// below the timing's own noise: the widest interquartile range of the two settings' steps and of the idle loops beside
/// them.
[[nodiscard]] TimeSaved time_saved(const StudyResult& result, std::size_t setting, std::size_t over);

/// Whether any setting's error at the device behind a round trip is above what the reference's uncertainty can bring
/// about: otherwise they cannot be told apart.
[[nodiscard]] bool resolves(const StudyResult& result, std::size_t round_trip);

/// Which setting to take behind each network, one entry each. Of a scene's key that is the most exact one, unless a
/// rougher one is less wrong at the device and saves time that counts; where none does, nothing is recommended in place
/// of the most exact one. A setting whose force points aside is warned of. Where the settings hardly differ, that they
/// do not matter; where their errors are below the reference's uncertainty, nothing is recommended.
[[nodiscard]] std::string recommendation(const StudyResult& result,
                                         double budget_us = std::numeric_limits<double>::infinity());

}  // namespace forcebound::lab
