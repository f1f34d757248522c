#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "tests/process/programs.hpp"
#include "tests/support/source_folder.hpp"

/// The binding in C#, under mono.
namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr auto kLimit = 120s;

/// A program in C#, with the library in a folder.
Ran run_mono(const std::string& folder, const std::string& program, Words arguments) {
  arguments.insert(arguments.begin(), {"LD_LIBRARY_PATH=" + folder, FORCEBOUND_MONO,
                                       std::string(FORCEBOUND_CSHARP) + "/" + program + ".exe"});
  return run("/usr/bin/env", arguments, kLimit);
}

std::string library_folder() { return std::filesystem::path(FORCEBOUND_LIBRARY).parent_path(); }

Ran run_with_library(const std::string& program, Words arguments) {
  return run_mono(library_folder(), program, std::move(arguments));
}

void expect_passes(const std::string& check) {
  const Ran ran = run_with_library("Checks", {check});
  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
}

/// Client --- relay, 5 ms --- server with the wall.
void expect_passes_with_server(const std::string& check) {
  const Server server({"--scene", "wall"});
  const Relay relay(server.address(), {"--netem", "delay 5ms 1ms loss 2%", "--seed", "1"});
  const Ran ran = run_with_library("Checks", {check, relay.address()});
  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
}

std::set<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::set<std::string> all;
  for (std::string line; std::getline(in, line);) all.insert(line);
  return all;
}

TEST(CSharp, DeclaresWhatTheHeaderDeclares) {
  const Ran header = run(FORCEBOUND_DECLARED, {});
  const Ran binding = run_with_library("Declared", {});
  ASSERT_EQ(header.exit_code, 0) << header.err;
  ASSERT_EQ(binding.exit_code, 0) << binding.err;
  const std::set<std::string> in_c = lines_of(header.out);
  EXPECT_THAT(in_c, testing::IsSupersetOf({"FB_INVALID = 1", "fb_law_tick(5)", "fb_motion.has: at 8, 4 bytes, uint"}));
  EXPECT_THAT(lines_of(binding.out), testing::ContainerEq(in_c));
}

TEST(CSharp, ReadsFactsAndRefusesWrongOnes) { expect_passes("FactsAreThoseOfTheFile"); }
TEST(CSharp, BoundsByALaw) { expect_passes("LawIsTheLibrarys"); }
TEST(CSharp, BoundsALeaderArm) { expect_passes("LeaderIsTheLibrarys"); }
TEST(CSharp, RefusesArraysOfWrongLengths) { expect_passes("WrongLengthsAreRefused"); }
TEST(CSharp, RefusesUseAfterDispose) { expect_passes("UseAfterDisposeIsRefused"); }
TEST(CSharp, DisposesALawAfterTheTickOfAnotherThread) { expect_passes("DisposeWaitsForTheTick"); }
TEST(CSharp, DoesNotAllocateInATick) { expect_passes("TickDoesNotAllocate"); }
TEST(CSharp, RefusesSettingsInOneLine) { expect_passes("SettingsAreRefusedWithOneLine"); }
TEST(CSharp, ServesAnEnvironment) { expect_passes("EnvironmentIsFelt"); }
TEST(CSharp, SendsZeroForceWhereAnEnvironmentThrows) { expect_passes("ExceptionsOfAnEnvironmentEndInZeroForce"); }
TEST(CSharp, RefusesClientsThatAnEnvironmentRefuses) { expect_passes("AnEnvironmentMayRefuseClients"); }
TEST(CSharp, RefusesServersInOneLine) { expect_passes("ServersAreRefusedWithOneLine"); }
TEST(CSharp, StepsASimulatorThatIsFelt) { expect_passes("SimulatorIsFeltBetweenItsSteps"); }
TEST(CSharp, EndsWithAServerThatRuns) { expect_passes("TheProgramMayEndWithItsServer"); }
TEST(CSharp, FeelsTheWallByCallbacks) { expect_passes_with_server("CallbacksFeelTheWall"); }
TEST(CSharp, ShowsZeroForceWhereACallbackThrows) { expect_passes_with_server("ExceptionsOfCallbacksEndInZeroForce"); }
TEST(CSharp, SurvivesCallbacksThatAllThrow) { expect_passes_with_server("EveryCallbackMayThrow"); }
TEST(CSharp, StopsTheDeviceWhileACallbackSleeps) { expect_passes_with_server("ACallbackOf100msIsLate"); }
TEST(CSharp, EndsAClientThatIsLost) { expect_passes_with_server("AClientThatIsLostEnds"); }
TEST(CSharp, EndsWithAClientThatRuns) { expect_passes_with_server("TheProgramMayEndWithoutDispose"); }
TEST(CSharp, DoesNotAllocateInLooking) { expect_passes_with_server("LookingDoesNotAllocate"); }

TEST(CSharp, SaysWhereItLookedForTheLibrary) {
  const TemporaryFolder folder;
  const Ran ran = run_mono(folder.path(), "Checks", {"LibraryIsMissing"});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("libforcebound.so not found, expected in a folder of LD_LIBRARY_PATH"));
}

TEST(CSharp, SaysForWhichProcessorALibraryIs) {
  constexpr std::size_t kClass = 4;
  constexpr std::size_t kMachine = 18;
  constexpr char kAArch64 = static_cast<char>(183);
  const TemporaryFolder folder;
  std::string library(4096, '\0');
  std::ifstream(FORCEBOUND_LIBRARY, std::ios::binary).read(library.data(), std::ssize(library));
  ASSERT_EQ(library[kClass], 2) << "of 64 bits";
  library[kMachine] = kAArch64;
  write_file(folder.file("libforcebound.so"), library);
  Ran ran = run_mono(folder.path(), "Checks", {"LibraryIsMissing"});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("libforcebound.so is for AArch64, expected an ELF library for x86-64"));
  write_file(folder.file("libforcebound.so"), "MZ, of another system");
  ran = run_mono(folder.path(), "Checks", {"LibraryIsMissing"});
  EXPECT_THAT(ran.out, HasSubstr("libforcebound.so is no ELF library, expected"));
}

TEST(CSharp, SaysThatALibraryIsAnother) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(FORCEBOUND_STRANGER, folder.file("libforcebound.so"));
  const Ran ran = run_mono(folder.path(), "Checks", {"LibraryIsMissing"});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("is another library: it has no fb_version"));
}

/// The number before `unit` in the sample's last line.
double printed(const Ran& ran, const std::string& pattern) {
  std::smatch match;
  if (!std::regex_search(ran.out, match, std::regex(pattern)))
    throw std::runtime_error("no " + pattern + ": " + ran.out);
  return std::stod(match[1]);
}

TEST(CSharpSample, FeelsAWallThroughARelayAndStaysPassive) {
  const Server server({"--scene", "wall"});
  const Relay relay(server.address(), {"--netem", "delay 5ms 1ms loss 2%", "--seed", "1"});
  const Ran law = run_with_library("FeelAWall", {relay.address()});
  EXPECT_EQ(law.exit_code, 0) << law.err;
  EXPECT_GT(printed(law, R"(([\d.]+) mm deep)"), 0);
  EXPECT_GT(printed(law, R"(([\d.]+) N,)"), 1);
  EXPECT_GE(printed(law, R"(least P (-?[\d.]+) mJ)"), 0);
  const Ran none = run_with_library("FeelAWall", {relay.address(), "none"});
  EXPECT_EQ(none.exit_code, 3) << none.err;
  EXPECT_LT(printed(none, R"(least P (-?[\d.]+) mJ)"), -1) << "the wall pushes back more than it took";
}

TEST(CSharpSample, EndsWithOneLineWithoutAServer) {
  const Ran ran = run_with_library("FeelAWall", {free_address()});
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_EQ(lines(ran.err), 1U) << ran.err;
}

TEST(UnityComponent, DrawsTipAndForceWithStandInsOfUnity) {
  const Server server({"--scene", "sphere"});
  const Ran ran = run_with_library("PlayUnity", {server.address()});
  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
}

const std::string kUnity = (source_folder() / "deploy/unity").string();

TEST(UnityPackage, HasTheBindingAndALibraryThatRuns) {
  const TemporaryFolder folder;
  const std::string package = folder.file("package");
  for (int time = 0; time < 2; ++time) {  // the second replaces the first
    const Ran made = run(kUnity.c_str(), {"--out", package, "--library", FORCEBOUND_LIBRARY});
    ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
    EXPECT_THAT(made.out, HasSubstr("never tried in Unity itself"));
  }
  EXPECT_EQ(content(package + "/Runtime/Forcebound.cs"), content(source_folder() / "client/csharp/Forcebound.cs"));
  const auto about = nlohmann::json::parse(content(package + "/package.json"));
  EXPECT_THAT(about["version"].get<std::string>(), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_TRUE(nlohmann::json::parse(content(package + "/Runtime/Forcebound.asmdef"))["allowUnsafeCode"]);
  EXPECT_THAT(content(package + "/README.md"), HasSubstr("never in Unity itself"));
  const Ran ran = run_mono(package + "/Plugins/x86_64", "Checks", {"LawIsTheLibrarys"});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
}

TEST(UnityPackage, TouchesNoOtherFolderAndTakesNoOtherFile) {
  const TemporaryFolder folder;
  write_file(folder.file("mine"), "mine");
  const Ran over = run(kUnity.c_str(), {"--out", folder.path(), "--library", FORCEBOUND_LIBRARY});
  EXPECT_EQ(over.exit_code, 2);
  EXPECT_THAT(over.err, HasSubstr("expected a new folder or an older package"));
  EXPECT_EQ(content(folder.file("mine")), "mine");
  const Ran no_library = run(kUnity.c_str(), {"--out", folder.file("new"), "--library", folder.file("mine")});
  EXPECT_EQ(no_library.exit_code, 2);
  EXPECT_THAT(no_library.err, HasSubstr("expected a libforcebound.so"));
  EXPECT_EQ(run(kUnity.c_str(), {"--outt"}).exit_code, 2);
}

}  // namespace
}  // namespace forcebound::test
