#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "forcebound/text/file.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::fuzz {
namespace {

class FuzzCorpus : public testing::TestWithParam<Target> {};

std::vector<std::filesystem::path> inputs_of(std::string_view target) {
  std::vector<std::filesystem::path> files;
  const auto folder = test::source_folder() / "tests" / "fuzz" / "corpus" / target;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.emplace_back(entry.path());
  std::ranges::sort(files);
  return files;
}

TEST_P(FuzzCorpus, EveryInputIsReadOrRefusedWholeAndCutShort) {
  GetParam().run({});
  const auto files = inputs_of(GetParam().name);
  ASSERT_FALSE(files.empty());
  for (const auto& file : files) {
    SCOPED_TRACE(file.string());
    const std::string content = text::read_file(file.string());
    const Bytes bytes = std::as_bytes(std::span(content));
    constexpr std::size_t kCuts = 8;
    for (std::size_t cut = 1; cut <= kCuts; ++cut) {
      EXPECT_NO_THROW(GetParam().run(bytes.first(bytes.size() * cut / kCuts)))
          << "its first " << bytes.size() * cut / kCuts << " bytes";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryTarget, FuzzCorpus, testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace forcebound::fuzz
