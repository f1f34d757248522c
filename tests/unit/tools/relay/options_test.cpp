#include "tests/tools/relay/options.hpp"

#include <gmock/gmock.h>

#include <cstdio>
#include <vector>

#include "forcebound/program/command_line.hpp"

namespace forcebound::relay {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<const char*> command_line(std::vector<const char*> more) {
  std::vector<const char*> line{"forcebound-relay", "--listen", "127.0.0.1:1", "--upstream", "[::1]:2"};
  line.insert(line.end(), more.begin(), more.end());
  return line;
}

Options read(const std::vector<const char*>& line, std::uint64_t random_seed = 42) {
  return read_command_line(static_cast<int>(line.size()), line.data(), random_seed);
}

/// How the program ends with such a command line.
struct Ended {
  int exit_code = 0;
  std::string out;
  std::string err;
};

Ended end_of(const std::vector<const char*>& line) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = program::run(kProgram, [&] {
    read(line);
    return -1;  // accepted
  });
  std::fflush(stdout);
  return {exit_code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(RelayOptions, ReadAddressesFilesAndSeed) {
  const Options options = read(command_line({"--seed", "7", "--trace", "t.csv", "--log", "l.csv"}));
  EXPECT_EQ(options.listen, (net::Endpoint{"127.0.0.1", 1}));
  EXPECT_EQ(options.upstream, (net::Endpoint{"::1", 2}));
  EXPECT_EQ(options.seed, 7U);
  EXPECT_EQ(options.trace, "t.csv");
  EXPECT_EQ(options.log, "l.csv");
}

TEST(RelayOptions, WithoutASeedTakeTheRandomOne) { EXPECT_EQ(read(command_line({}), 99).seed, 99U); }

TEST(RelayOptions, NetemIsForBothDirectionsUnlessOneHasItsOwn) {
  const Options both = read(command_line({"--netem", "loss 5%"}));
  EXPECT_EQ(both.up, netem::parse_netem("loss 5%"));
  EXPECT_EQ(both.down, netem::parse_netem("loss 5%"));
  const Options own = read(command_line({"--netem", "loss 5%", "--netem-up", "delay 1ms"}));
  EXPECT_EQ(own.up, netem::parse_netem("delay 1ms"));
  EXPECT_EQ(own.down, netem::parse_netem("loss 5%"));
  EXPECT_EQ(own.up_words, "delay 1ms");
  EXPECT_EQ(own.down_words, "loss 5%");
  const Options perfect = read(command_line({"--netem", "loss 5%", "--netem-down", ""}));
  EXPECT_EQ(perfect.down, netem::NetemParameters{});
}

TEST(RelayOptions, WordsToPrintHaveUnits) {
  EXPECT_EQ(read(command_line({"--netem", "delay 50 10"})).up_words, "delay 50us 10us");
}

TEST(RelayOptions, BlackholesAreOfTheWaysTheyName) {
  const Options options = read(command_line({"--blackhole", "up:1-2", "--blackhole", "both:5-6.5"}));
  ASSERT_EQ(options.up_blackholes.size(), 2U);
  EXPECT_EQ(options.up_blackholes[0].to, std::chrono::seconds{2});
  ASSERT_EQ(options.down_blackholes.size(), 1U);
  EXPECT_EQ(options.down_blackholes[0].to, std::chrono::milliseconds{6500});
}

TEST(RelayOptions, HelpTeachesAndEndsWell) {
  const Ended help = end_of({"forcebound-relay", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("loss gemodel P"), HasSubstr("--trace"), HasSubstr("--blackhole"),
                              HasSubstr("Differences from tc"), HasSubstr("Examples, each with")));
}

TEST(RelayOptions, VersionEndsWell) {
  const Ended version = end_of({"forcebound-relay", "--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, HasSubstr("forcebound-relay " FORCEBOUND_VERSION));
}

struct WrongUse {
  std::vector<const char*> line;
  const char* says;
};
void PrintTo(const WrongUse& use, std::ostream* out) { *out << use.says; }

class RelayOptionsRefuse : public testing::TestWithParam<WrongUse> {};

TEST_P(RelayOptionsRefuse, WithExitCodeTwoNamingTheOption) {
  const Ended end = end_of(GetParam().line);
  EXPECT_EQ(end.exit_code, 2);
  EXPECT_THAT(end.err, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    WrongUse, RelayOptionsRefuse,
    testing::Values(WrongUse{{"forcebound-relay"}, "--listen"},
                    WrongUse{{"forcebound-relay", "--listen", "a:1"}, "--upstream"},
                    WrongUse{{"forcebound-relay", "--listen", "a", "--upstream", "b:1"}, "--listen: 'a'"},
                    WrongUse{command_line({"--bogus"}), "--bogus"},
                    WrongUse{command_line({"--netem", "loss much"}), "--netem: 'much'"},
                    WrongUse{command_line({"--netem-up", "gap 3"}), "--netem-up: 'gap'"},
                    WrongUse{command_line({"--netem-down", "delay x"}), "--netem-down: 'x'"},
                    WrongUse{command_line({"--blackhole", "up:5"}), "--blackhole: 'up:5'"},
                    WrongUse{command_line({"--seed", "-3"}),
                             "--seed: must be a whole number from 0 to 18446744073709551615, got '-3'"},
                    WrongUse{command_line({"--seed", "seven"}), "'seven'"}));

}  // namespace
}  // namespace forcebound::relay
