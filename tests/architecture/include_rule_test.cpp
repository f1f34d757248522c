#include "tests/architecture/include_rule.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <set>

#include "tests/architecture/file_circles.hpp"
#include "tests/architecture/privileges.hpp"
#include "tests/support/page.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::architecture {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Of both rules.
std::vector<Violation> violations(std::string_view file, std::string_view text) {
  std::vector<Violation> found = include_violations(file, text);
  const std::vector<Violation> more = privilege_violations(file, text);
  found.insert(found.end(), more.begin(), more.end());
  return found;
}

std::string only_violation(std::string_view file, std::string_view text) {
  const auto found = violations(file, text);
  EXPECT_THAT(found, SizeIs(1)) << file << ": " << text;
  return found.empty() ? "" : to_string(found.front());
}

TEST(IncludeRule, LetsEachConceptIncludeItselfAndWhatItKnows) {
  EXPECT_THAT(violations("common/forcebound/control/law.cpp",
                         "#include \"forcebound/control/law.hpp\"\n#include <Eigen/Core>\n"),
              IsEmpty());
  EXPECT_THAT(violations("common/forcebound/wire/codec.hpp", "#include \"forcebound/control/vector.hpp\"\n"),
              IsEmpty());
  EXPECT_THAT(violations("common/forcebound/scene/plan.cpp", "#include \"forcebound/scene/effects/surface.hpp\"\n"),
              IsEmpty());
  EXPECT_THAT(violations("client/forcebound/client/app/main.cpp",
                         "#include <thread>\n#include \"forcebound/client/session/session.hpp\""),
              IsEmpty());
}

TEST(IncludeRule, FindsAForbiddenConceptAndSaysWhereAndWhatIsAllowed) {
  EXPECT_EQ(only_violation("common/forcebound/scene/effects/surface.cpp",
                           "#include \"forcebound/control/vector.hpp\"\n#include \"forcebound/wire/messages.hpp\"\n"),
            "common/forcebound/scene/effects/surface.cpp:2: forcebound/scene/effects must not include "
            "'forcebound/wire/messages.hpp', only what lies below forcebound/scene/effects, forcebound/config, "
            "forcebound/control, forcebound/scene/geometry, forcebound/text");
}

TEST(IncludeRule, KeepsClientAndServerApart) {
  EXPECT_THAT(only_violation("client/forcebound/client/session/session.cpp",
                             "#include \"forcebound/server/session/server.hpp\"\n"),
              HasSubstr("must not include"));
  EXPECT_THAT(only_violation("server/forcebound/server/session/server.cpp",
                             "#include \"forcebound/client/session/session.hpp\"\n"),
              HasSubstr("must not include"));
}

TEST(IncludeRule, DoesNotTakeAFolderForOneWhoseNameItBegins) {
  EXPECT_THAT(only_violation("common/forcebound/net/address.cpp", "#include \"forcebound/timeline/x.hpp\"\n"),
              HasSubstr("must not include"));
}

TEST(IncludeRule, LeavesControlOnlyTheStandardLibraryAndEigen) {
  EXPECT_THAT(only_violation("common/forcebound/control/ledger.cpp", "#include <zlib.h>\n"), HasSubstr("Eigen"));
  EXPECT_THAT(only_violation("common/forcebound/control/ledger.cpp", "#include <unistd.h>\n"), HasSubstr("Eigen"));
}

TEST(IncludeRule, KeepsGeneratedCodeOutOfHeaders) {
  constexpr std::string_view kText = "#include \"forcebound/v1/session.pb.h\"\n";
  EXPECT_THAT(violations("common/forcebound/wire/codec.cpp", kText), IsEmpty());
  EXPECT_THAT(only_violation("common/forcebound/wire/codec.hpp", kText),
              HasSubstr(".cpp files of common/forcebound/wire"));
}

TEST(IncludeRule, KeepsTheTomlLibraryInOneFile) {
  EXPECT_THAT(violations("common/forcebound/config/node.cpp", "#include <toml++/toml.h>\n"), IsEmpty());
  EXPECT_THAT(only_violation("common/forcebound/config/node.hpp", "#include <toml++/toml.h>\n"),
              HasSubstr("common/forcebound/config/node.cpp"));
}

TEST(IncludeRule, KeepsAsioInTheFilesOfUdp) {
  EXPECT_THAT(violations("common/forcebound/net/udp_link.cpp", "#include <asio.hpp>\n"), IsEmpty());
  EXPECT_THAT(violations("common/forcebound/net/internal/udp_address.hpp", "#include <asio.hpp>\n"), IsEmpty());
  EXPECT_THAT(only_violation("common/forcebound/net/impairment.cpp", "#include <asio/ip/udp.hpp>\n"),
              HasSubstr("Asio"));
}

TEST(IncludeRule, KeepsClockThreadsAndRandomnessOutOfTheCore) {
  EXPECT_THAT(
      only_violation("client/forcebound/client/session/session.cpp", "auto t = std::chrono::steady_clock::now();\n"),
      HasSubstr("clock"));
  EXPECT_THAT(only_violation("server/forcebound/server/session/server.cpp", "std::jthread worker;\n"),
              HasSubstr("threads"));
  EXPECT_THAT(only_violation("common/forcebound/scene/state.cpp", "#include <sys/socket.h>\n"), HasSubstr("sockets"));
  EXPECT_THAT(only_violation("common/forcebound/device/simulated/operator.cpp", "std::random_device entropy;\n"),
              HasSubstr("random"));
  EXPECT_THAT(
      only_violation("client/forcebound/client/session/session.cpp", "#include \"forcebound/time/steady_clock.hpp\"\n"),
      HasSubstr("clock"));
}

TEST(IncludeRule, KeepsTestCodeOutOfProgramsAndTools) {
  EXPECT_THAT(
      only_violation("client/forcebound/client/app/main.cpp", "#include \"tests/tools/sim/virtual_clock.hpp\"\n"),
      HasSubstr("must not include"));
  EXPECT_THAT(only_violation("client/forcebound/client/commands/identify/guide.cpp",
                             "#include \"tests/tools/lab/identification/study.hpp\"\n"),
              HasSubstr("must not include"));
  EXPECT_THAT(only_violation("tests/tools/lab/reproduce.cpp", "#include \"tests/support/process.hpp\"\n"),
              HasSubstr("must not include"));
  EXPECT_THAT(violations("tests/unit/record/x_test.cpp", "#include \"tests/support/process.hpp\"\n"), IsEmpty());
}

TEST(IncludeRule, KeepsTheEmulatedNetworkApartFromTheSimulator) {
  EXPECT_THAT(only_violation("tests/tools/netem/trace.cpp", "#include \"tests/tools/sim/closed_loop.hpp\"\n"),
              HasSubstr("must not include"));
}

TEST(IncludeRule, KeepsTheLabsTrialsApartFromItsStudies) {
  const auto trials = [](std::string_view line) { return only_violation("tests/tools/lab/trials/task.cpp", line); };
  EXPECT_THAT(trials("#include \"tests/tools/lab/commands.hpp\"\n"), HasSubstr("must not include"));
  EXPECT_THAT(trials("#include \"tests/tools/lab/comparison/trial.hpp\"\n"), HasSubstr("must not include"));
  EXPECT_THAT(
      only_violation("tests/tools/lab/accuracy/along.cpp", "#include \"tests/tools/lab/comparison/trial.hpp\"\n"),
      HasSubstr("must not include"));
}

TEST(IncludeRule, KeepsNumbersFromTheProcesssLocale) {
  const char* const anywhere = "common/forcebound/record/run_info.cpp";
  for (const char* const code :
       {"std::ostringstream text;", "std::setlocale(LC_ALL, \"\");", "out.imbue(std::locale());",
        "double x = std::strtod(text, nullptr);", "double x = std::stod(text);", "snprintf(text, 9, \"%.17g\", value);",
        "printf(\"at %5.1f mm\\n\", x_mm);", "fmt::format(\"{:.3L}\", x);", "std::to_string(facts.period_s)"}) {
    EXPECT_THAT(only_violation(anywhere, code), HasSubstr("numbers by the process's locale belong only to ")) << code;
  }
  for (const char* const code :
       {"control::ClassicText text;", "snprintf(text, 9, \"%s: 5 %% of %d\", name, count);", "100 % full",
        "fmt::format(\"{:.3f} {}\", x, Length);", "std::to_string(row)", "std::istringstream lines(text);"}) {
    EXPECT_THAT(violations(anywhere, code), IsEmpty()) << code;
  }
  EXPECT_THAT(violations("client/drivers/pen.c", "double x = strtod(text, &end);"), SizeIs(1));
}

TEST(IncludeRule, IgnoresComments) {
  EXPECT_THAT(violations("common/forcebound/control/law.hpp", "// not std::thread, not steady_clock\n"), IsEmpty());
}

TEST(IncludeRule, RefusesAFolderWithoutARule) {
  EXPECT_THAT(only_violation("common/forcebound/audio/horn.cpp", ""), HasSubstr("no rule"));
}

TEST(IncludeTable, LeavesOutWhatFollowsFromOthers) {
  const std::string table = include_table("common");
  EXPECT_THAT(table, HasSubstr("| `baselines` | `config` |\n")) << "config includes control and text";
  EXPECT_THAT(table, HasSubstr("| `child` | `text` |\n"));
  EXPECT_THAT(include_table("client"), ContainsRegex("\\| `commands/report` \\| `commands`, `common`'s .*`results`"))
      << "a folder and one within it include each other";
}

TEST(Pages, ListWhatEachFolderMayInclude) {
  for (const char* const page : {"common", "client", "server", "tests"}) {
    test::expect_on_page(std::string(page) + "/README.md", "includes", include_table(page));
  }
}

TEST(FileCircles, AreNamedWithEachOfTheirIncludes) {
  EXPECT_THAT(file_circles({{"common/forcebound/net/a.hpp", ""},
                            {"common/forcebound/net/a.cpp", "// first\n#include \"forcebound/net/b.hpp\"\n"},
                            {"common/forcebound/net/internal/b.hpp", "#include \"forcebound/net/c.hpp\"\n"},
                            {"common/forcebound/net/b.hpp", "#include \"forcebound/net/internal/c.hpp\"\n"},
                            {"common/forcebound/net/c.cpp", "#include \"forcebound/net/a.hpp\"\n"},
                            {"common/forcebound/net/d.cpp", "#include \"forcebound/net/a.hpp\"\n"}}),
              ElementsAre("common/forcebound/net/a.cpp:2 includes 'forcebound/net/b.hpp', "
                          "common/forcebound/net/b.hpp:1 includes 'forcebound/net/internal/c.hpp', "
                          "common/forcebound/net/c.cpp:1 includes 'forcebound/net/a.hpp'"));
}

TEST(FileCircles, AHeaderAndItsSourceAreOneFile) {
  EXPECT_THAT(file_circles({{"common/forcebound/net/a.hpp", "#include \"forcebound/net/b.hpp\"\n"},
                            {"common/forcebound/net/a.cpp", "#include \"forcebound/net/internal/a.hpp\"\n"},
                            {"common/forcebound/net/b.cpp", "#include \"forcebound/net/b.hpp\"\n"}}),
              IsEmpty());
}

/// All sources, by path.
const std::map<std::string, std::string>& sources() {
  namespace fs = std::filesystem;
  static const std::map<std::string, std::string> kSources = [] {
    std::map<std::string, std::string> texts;
    const fs::path& root = test::source_folder();
    for (const char* side : {"common", "client", "server", "tests"}) {
      for (const auto& entry : fs::recursive_directory_iterator(root / side)) {
        const fs::path& path = entry.path();
        if (!std::set<fs::path>{".cpp", ".hpp", ".c", ".h"}.contains(path.extension())) continue;
        texts[path.lexically_relative(root).generic_string()] = test::content(path);
      }
    }
    return texts;
  }();
  return kSources;
}

TEST(SourceTree, ObeysTheIncludeRule) {
  for (const auto& [file, text] : sources()) {
    for (const auto& violation : violations(file, text)) ADD_FAILURE() << to_string(violation);
  }
  EXPECT_GT(sources().size(), 10U) << "the sources were not found under " << test::source_folder();
}

TEST(SourceTree, HasNoFilesThatIncludeEachOtherInACircle) { EXPECT_THAT(file_circles(sources()), IsEmpty()); }

}  // namespace
}  // namespace forcebound::architecture
