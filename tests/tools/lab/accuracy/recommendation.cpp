#include "tests/tools/lab/accuracy/recommendation.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/accuracy/percent.hpp"

namespace forcebound::lab {
namespace {

using text::rounded;

// Settings whose errors differ by less than this share of the least count as equal for the hand.
constexpr double kAlike = 0.05;

/// Of the settings that worked within the budget, the one with the least error at the same states; the last of equals.
/// Call only if there is a best.
std::size_t most_exact(const StudyResult& result, double budget_us) {
  std::size_t exact = result.settings.size();
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    const StudiedSetting& setting = result.settings[i];
    if (!setting.trouble.empty() || setting.cost.median_us > budget_us) continue;
    if (exact == result.settings.size() || setting.at_states.force <= result.settings[exact].at_states.force) exact = i;
  }
  return exact;
}

/// If no setting is much better than another at the device: the other causes of the error.
std::string hardly_matters(const StudyResult& result, std::size_t which, std::size_t best) {
  const auto error = [&](std::size_t i) { return result.settings[i].behind[which].error; };
  const DeviceError least = error(best);
  double worst = 0;
  double smallest = least.total;  // less than the best's where the more exact setting takes too long, or is not passive
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    if (!result.settings[i].trouble.empty()) continue;
    worst = std::max(worst, error(i).total);
    smallest = std::min(smallest, error(i).total);
  }
  if (worst > (1 + kAlike) * smallest) return {};
  return "; but " + result.key + " makes little difference here: the worst setting has " + percent(worst) +
         ", of which " + percent(least.age.share + least.hold.share) + " are the age of forces";
}

std::string direction_warning(const StateError& error) {
  if (!(error.direction_p95_deg > kDirectionWarning_deg)) return {};
  return "  warning: at the same states its force points " + rounded(error.direction_median_deg) + " deg aside (p95 " +
         rounded(error.direction_p95_deg) + " deg) and is " + percent(error.force) + " off\n";
}

std::string criterion_text(const StudyResult& result) {
  return "A rougher setting is recommended only where it saves time: " + rounded(100 * kTimeShareThatCounts) +
         " % of the server's step of " + rounded(1e-3 * result.server_step_us) +
         " ms (--rate), and no less than the times scatter here\n";
}

std::string behind(const StudyResult& result, std::size_t which, double budget_us) {
  const auto best = best_setting(result, which, budget_us);
  if (!best) {
    return "nothing that worked" + std::string(result.same_scene ? " and stayed passive" : "") + " takes at most " +
           rounded(budget_us) + " us\n";
  }
  if (!resolves(result, which)) {
    return "nothing recommended: every setting's E_dev is below " + percent(3 * result.free_uncertainty) +
           ", which the reference's uncertainty alone can bring about; finer levels, or an exact --reference, would "
           "tell them apart\n";
  }
  const std::size_t exact = result.same_scene ? *best : most_exact(result, budget_us);
  const TimeSaved saved = time_saved(result, *best, exact);
  const std::string& exact_value = result.settings[exact].value;
  const StudiedSetting& setting = result.settings[*best];
  if (*best != exact && !saved.counts()) {
    return "nothing recommended in place of " + result.key + " = " + exact_value + ": " + setting.value +
           (saved.us < 0 ? " takes " : " saves ") + rounded(std::abs(saved.us)) + " us a step" +
           (saved.us < 0 ? " more" : "") + "; from " + rounded(saved.counted_us) + " us on it counts\n" +
           direction_warning(setting.at_states);
  }
  std::string text = result.key + " = " + setting.value + ", E_dev " +
                     percent_above(setting.behind[which].error.total, result.free_uncertainty) + ", " +
                     rounded(setting.cost.median_us) + " us a step";
  if (*best != exact) text += ", " + rounded(saved.us) + " us less than the most exact, " + exact_value;
  return text + hardly_matters(result, which, *best) + "\n" + direction_warning(setting.at_states);
}

}  // namespace

bool resolves(const StudyResult& result, std::size_t round_trip) {
  return std::ranges::any_of(result.settings, [&](const StudiedSetting& setting) {
    return setting.trouble.empty() && is_above(setting.behind[round_trip].error.total, result.free_uncertainty);
  });
}

TimeSaved time_saved(const StudyResult& result, std::size_t setting, std::size_t over) {
  const StudiedSetting& one = result.settings[setting];
  const StudiedSetting& other = result.settings[over];
  const double noise_us =
      std::max({one.cost.spread_us, one.idle.spread_us, other.cost.spread_us, other.idle.spread_us});
  return {.us = other.cost.median_us - one.cost.median_us,
          .counted_us = std::max(kTimeShareThatCounts * result.server_step_us, noise_us)};
}

std::string recommendation(const StudyResult& result, double budget_us) {
  std::string text;
  if (!result.reference_trouble.empty()) {
    text = "unreliable: the reference itself failed (" + result.reference_trouble + ")\n";
  }
  for (std::size_t which = 0; which < result.settings.front().behind.size(); ++which) {
    text += "behind " + rounded(1e3 * result.settings.front().behind[which].round_trip_s) +
            " ms: " + behind(result, which, budget_us);
  }
  if (!result.same_scene) text += criterion_text(result);
  return text;
}

}  // namespace forcebound::lab
