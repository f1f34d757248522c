#include "forcebound/client/commands/doctor/felt_stiffness.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "forcebound/text/file.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::client::commands {
namespace {

const std::map<std::string, std::vector<std::string>> kStudiedClasses{
    {"static", {"plane", "primitives", "edge", "corner", "friction", "height field", "mesh of 5856", "mesh of 70000"}},
    {"tissue", {"tissue"}},
    {"body", {"body by hand only"}},
    {"body-at-stop", {"body against a stop"}}};

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// The worst median of the classes' scenes behind that round trip.
double studied_share(const nlohmann::json& study, const FeltClass& felt, const char* rendering,
                     const std::string& condition) {
  const std::vector<std::string>& classes = kStudiedClasses.at(felt.name);
  double worst = std::numeric_limits<double>::infinity();
  for (const nlohmann::json& row : study.at("rows")) {
    const auto its_class = row.at("class").get<std::string>();
    const bool counts = std::find(classes.begin(), classes.end(), its_class) != classes.end();
    if (!counts || row.at("condition") != condition) continue;
    worst = std::min(worst, median_of(row.at(rendering).at("stiffness").get<std::vector<double>>()));
  }
  return worst;
}

TEST(FeltStiffness, IsThatOfTheCommittedResults) {
  const auto study =
      nlohmann::json::parse(text::read_file((test::source_folder() / "deploy" / "rendering-results.json").string()));
  ASSERT_EQ(felt_classes().size(), kStudiedClasses.size());
  for (const FeltClass& felt : felt_classes()) {
    SCOPED_TRACE(felt.name);
    for (std::size_t i = 1; i < FeltClass::kBehind_ms.size(); ++i) {
      const std::string condition = std::to_string(static_cast<int>(FeltClass::kBehind_ms[i])) + " ms";
      EXPECT_NEAR(felt.at_server[i], studied_share(study, felt, "remote", condition), 1e-3) << condition;
      EXPECT_NEAR(felt.at_client[i], studied_share(study, felt, "local", condition), 1e-3) << condition;
    }
    EXPECT_EQ(felt.at_server[0], 1);
    EXPECT_EQ(felt.at_client[0], 1);
  }
}

TEST(FeltStiffness, GoesStraightBetweenWhatWasMeasuredAndNotOnBeyond) {
  constexpr std::array<double, 4> kShares{1, 0.8, 0.4, 0.1};
  EXPECT_DOUBLE_EQ(felt_share(kShares, 0), 1);
  EXPECT_DOUBLE_EQ(felt_share(kShares, 10), 0.9);
  EXPECT_DOUBLE_EQ(felt_share(kShares, 20), 0.8);
  EXPECT_DOUBLE_EQ(felt_share(kShares, 60), 0.6);
  EXPECT_DOUBLE_EQ(felt_share(kShares, 100), 0.4);
  EXPECT_DOUBLE_EQ(felt_share(kShares, 150), 0.25);
  EXPECT_DOUBLE_EQ(felt_share(kShares, 200), 0.1);
  EXPECT_DOUBLE_EQ(felt_share(kShares, 5000), 0.1);
  EXPECT_DOUBLE_EQ(felt_share(kShares, -1), 1);
}

}  // namespace
}  // namespace forcebound::client::commands
