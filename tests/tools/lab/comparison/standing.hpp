#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/text/marks.hpp"
#include "tests/tools/lab/comparison/comparison_run.hpp"

namespace forcebound::lab {

/// The marks in a document between which `to_markdown`'s text stands.
inline constexpr text::Marks kComparisonMarks{"<!-- comparison: made by deploy/comparison -->\n",
                                              "<!-- /comparison -->\n"};

/// A few numbers for each law. Over scenes and stiffnesses: the least P, the most of direction error and drift, the
/// median of everything else; with the real device; P with both.
[[nodiscard]] nlohmann::ordered_json standings(const ComparisonResult& result);

/// For a terminal: passivity, displayed stiffness through each network, stiffest stable wall, and the parameters found,
/// of each law. @param standings as `standings` made them
[[nodiscard]] std::string to_text(const nlohmann::ordered_json& standings);

/// The same for common/forcebound/baselines/README.md, shorter.
[[nodiscard]] std::string comparison_markdown(const nlohmann::ordered_json& standings);

/// A row for each trial.
[[nodiscard]] std::string to_csv(const ComparisonResult& result);

}  // namespace forcebound::lab
