#include "tests/tools/lab/accuracy/study_figure.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "forcebound/text/table.hpp"
#include "tests/tools/lab/accuracy/study_markdown.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

std::string study_csv(const Json& study) {
  text::Table table({{"setting"},
                     {"step_us"},
                     {"round_trip_ms"},
                     {"error"},
                     {"model"},
                     {"extrapolation"},
                     {"age"},
                     {"hold"},
                     {"bounding"},
                     {"least_error"},
                     {"error_at_states"},
                     {"velocity_error_at_states"},
                     {"failed"}});
  const Json& reference = study.at("reference");
  // An error below three times the reference's uncertainty is no more than that bound.
  const auto at_states = [&](const Json& error, const char* uncertainty) {
    return results::figure_number(std::max(error.get<double>(), 3 * reference.at(uncertainty).get<double>()));
  };
  const bool has_bodies = study.at("ticks_between_states") > 0;
  const Json& settings = study.at("settings");
  for (std::size_t network = 0; network < settings.at(0).at("behind").size(); ++network) {
    const std::size_t best = best_behind(study, network);
    for (std::size_t i = 0; i < settings.size(); ++i) {
      const Json& behind = settings[i].at("behind").at(network);
      // Studies from before there was local rendering have no extrapolation.
      const auto share = [&](const char* part) {
        return behind.contains(part) ? results::figure_number(behind.at(part).at("share")) : std::string("0");
      };
      table.add({settings[i].at("value").get<std::string>(),
                 results::figure_number(settings[i].at("step_us").at("median")),
                 results::figure_number(1e3 * behind.at("round_trip_s").get<double>()),
                 results::figure_number(behind.at("error")), share("model"), share("extrapolation"), share("age"),
                 share("hold"), share("bounding"), i == best ? "1" : "0",
                 at_states(settings[i].at("force_error"), "uncertainty"),
                 has_bodies ? at_states(settings[i].at("velocity_error"), "velocity_uncertainty") : "0",
                 settings[i].at("trouble").get<std::string>().empty() ? "0" : "1"});
    }
  }
  return table.to_csv();
}

}  // namespace

results::Figure study_figure(const Json& study) {
  const std::string fixed = study.at("set");
  const std::string hand = study.at("hand");
  const std::string trouble = study.at("reference").at("trouble");
  return {.script = text::text_of(figure_scripts(), "accuracy"),
          .csv = study_csv(study),
          .subtitle = study.at("key").get<std::string>() + (fixed.empty() ? "" : " with " + fixed) + ", " +
                      hand.substr(0, hand.find(',')) + (trouble.empty() ? "" : "; the reference itself failed")};
}

}  // namespace forcebound::lab
