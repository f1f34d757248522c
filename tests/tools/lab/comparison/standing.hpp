#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/tools/lab/comparison/comparison_run.hpp"
#include "tests/tools/lab/marks.hpp"

namespace forcebound::lab {

/// What is between these marks of a document, `to_markdown` wrote.
inline constexpr Marks kComparisonMarks{"<!-- comparison: made by deploy/comparison -->\n", "<!-- /comparison -->\n"};

/// All laws, each in a few numbers. Over scenes and stiffnesses: the worst P, the most of direction error and drift,
/// the median of everything else; with the real device but for P, which is told of both.
[[nodiscard]] nlohmann::ordered_json standings(const ComparisonResult& result);

/// For a terminal: who stays passive, what each shows through each network, how stiff a wall each bears, and the
/// parameters that were found. @param standings as `standings` made them
[[nodiscard]] std::string to_text(const nlohmann::ordered_json& standings);

/// The same for common/forcebound/baselines/README.md, shorter.
[[nodiscard]] std::string comparison_markdown(const nlohmann::ordered_json& standings);

/// A row for each contest.
[[nodiscard]] std::string to_csv(const ComparisonResult& result);

}  // namespace forcebound::lab
