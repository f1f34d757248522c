#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>

#include "tests/support/source_folder.hpp"

namespace forcebound::architecture {
namespace {

using Names = std::set<std::string>;

/// What the pattern's first group matches in the lines of a file that the line's pattern matches.
Names names_in(const std::filesystem::path& file, const std::regex& of_line, const std::regex& name) {
  Names names;
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);) {
    if (!std::regex_search(line, of_line)) continue;
    for (std::sregex_iterator found(line.begin(), line.end(), name); found != std::sregex_iterator(); ++found) {
      names.insert((*found)[1]);
    }
  }
  return names;
}

// "Proof, A5" stands in a comment beside the lines that rely on A5.
TEST(Proof, EachAssumptionIsQuotedWhereTheLawReliesOnIt) {
  const std::filesystem::path control = test::source_folder() / "common/forcebound/control";
  const std::regex assumption(R"(\*\*(A[0-9]+), )");
  const Names stated = names_in(control / "README.md", std::regex(R"(^\* \*\*A[0-9]+, )"), assumption);
  Names quoted;
  for (const auto& entry : std::filesystem::directory_iterator(control)) {
    if (entry.path().extension() == ".md") continue;
    quoted.merge(names_in(entry.path(), std::regex("//.*[Pp]roof, A[0-9]"), std::regex(R"(\b(A[0-9]+)\b)")));
  }
  EXPECT_GE(stated.size(), 10U);
  EXPECT_EQ(quoted, stated);
}

}  // namespace
}  // namespace forcebound::architecture
