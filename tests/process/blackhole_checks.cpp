#include "tests/process/blackhole_checks.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "tests/process/passive.hpp"
#include "tests/process/programs.hpp"
#include "tests/support/becomes_true.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr auto kContact = 3s;  // from the relay's start to its blackhole

struct Way {
  std::string name;
  TemporaryFolder folder{};
  std::unique_ptr<Relay> relay{};
  std::unique_ptr<Client> client{};
};

void start(Way& way, const std::string& server, std::chrono::seconds duration) {
  const std::string hole =
      way.name + ":" + std::to_string(kContact.count()) + "-" + std::to_string((kContact + duration).count());
  way.relay = std::make_unique<Relay>(server, Words{"--blackhole", hole, "--log", way.folder.file("log.csv")});
  way.client = std::make_unique<Client>(way.relay->address(), Words{"--device", "omni", "--operator", "trace-sphere"});
}

/// Whether its forces are fresh again after those of about the duration.
bool is_over(const Way& way, std::chrono::seconds duration) {
  static const std::regex kWithout(R"(forces are fresh again after ([0-9.]+) s)");
  const std::string said = way.client->err();
  return std::any_of(std::sregex_iterator(said.begin(), said.end(), kWithout), {}, [&](const std::smatch& without) {
    return std::stod(without[1]) > static_cast<double>(duration.count()) - 1;
  });
}

void expect_reported(const Way& way, std::chrono::seconds duration) {
  const nlohmann::json summary = way.client->summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
  EXPECT_GT(summary["contact_ticks"], 0);
  EXPECT_GE(summary["blackouts"]["count"], 1) << "a machine that gives a program no time makes further ones";
  EXPECT_GE(summary["blackouts"]["longest_s"].get<double>(), static_cast<double>(duration.count()) - 0.1);
  EXPECT_GT(summary["late_force"]["dropped_ticks"], 0);
  EXPECT_THAT(unwrapped(way.client->err()), HasSubstr("forces are fresh again"));

  const nlohmann::json& longest = summary["blackouts"]["longest"];
  EXPECT_EQ(longest["died"], way.name) << longest;
  const bool up = way.name == "up";
  EXPECT_THAT(unwrapped(way.client->out()), HasSubstr("nothing came back from " + way.relay->address() + " for "));
  EXPECT_THAT(unwrapped(way.client->out()), HasSubstr(up ? "(up dead)" : "motions arrived there (up alive), 0 of "));

  // The datagrams missing are those that the relay dropped, except for handshakes meanwhile, and for motions after the
  // server closed the session, which no server counts.
  const std::string log = content(way.folder.file("log.csv"));
  const std::size_t swallowed = occurrences(log, ",blackout,");
  const double handshakes = 20 + 2.0 * static_cast<double>(duration.count());
  EXPECT_NEAR(longest[up ? "lost_up" : "lost_down"].get<double>(), static_cast<double>(swallowed), handshakes);
  EXPECT_EQ(longest[up ? "lost_down" : "lost_up"], 0);
  EXPECT_EQ(log.find(up ? "down,1,blackout" : "up,1,blackout"), std::string::npos);
}

}  // namespace

void expect_dead_ways_are_reported(std::chrono::seconds duration) {
  const Server server({"--scene", "sphere"});
  std::vector<Way> ways(2);
  ways[0].name = "up";
  ways[1].name = "down";
  for (Way& way : ways) start(way, server.address(), duration);
  for (Way& way : ways) {
    SCOPED_TRACE("dead way: " + way.name);
    EXPECT_TRUE(becomes_true([&] { return is_over(way, duration); }, kContact + duration + kPatience));
    EXPECT_EQ(way.client->stop(), 0);
    EXPECT_EQ(way.relay->stop(), 0);
    expect_reported(way, duration);
  }
}

}  // namespace forcebound::test
