#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "forcebound/http/client.hpp"
#include "tests/process/programs.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

/// What a program with a page gives at /metrics, once `text` is in it.
std::string metrics_with(Process& program, const std::string& text) {
  EXPECT_TRUE(program.wait_for("/?token="));
  EXPECT_TRUE(program.wait_for("\n"));
  const std::string out = program.out();
  std::smatch match;
  static const std::regex kAddress(R"(http://([0-9.]+):(\d+)/\?token=([0-9a-f]+))");
  if (!std::regex_search(out, match, kAddress)) return "no address in: " + out;
  const http::Url url{.host = match[1], .port = match[2], .target = "/metrics?token=" + match[3].str()};
  http::Response answer;
  EXPECT_TRUE(becomes_true([&] {
    answer = http::ask(url, {}, 10s);
    return answer.status != 200 || answer.body.find(text) != std::string::npos;
  }));
  return answer.body;
}

std::set<std::string> names_in(const std::string& text, const std::regex& pattern) {
  std::set<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern); match != std::sregex_iterator(); ++match) {
    names.insert((*match)[1]);
  }
  return names;
}

TEST(Metrics, AreThoseThatTheDashboardNames) {
  Server server({"--scene", "sphere", "--page", "0"});
  Client client(server.address(), {"--scene", "sphere", "--page", "0"});
  const std::string found = metrics_with(server, "forcebound_server_scene_compute_seconds_count{scene=\"sphere\"}") +
                            metrics_with(client, "forcebound_client_least_passivity_joules");
  EXPECT_EQ(client.stop(SIGINT), client.expected_end());
  const std::regex line(R"((?:^|\n)(forcebound_[a-z_]+)[ {])");
  const std::set<std::string> there = names_in(found, line);
  const json dashboard = json::parse(content(source_folder() / "deploy/grafana/forcebound.json"));
  ASSERT_GE(dashboard["panels"].size(), 10U);
  static const std::regex kName("(forcebound_[a-z_]+)");
  for (const json& panel : dashboard["panels"]) {
    for (const json& target : panel["targets"]) {
      const auto named = names_in(target["expr"].get<std::string>(), kName);
      EXPECT_FALSE(named.empty()) << target;
      for (const std::string& name : named) EXPECT_TRUE(there.contains(name)) << panel["title"] << ": " << name;
    }
  }
}

TEST(Metrics, AreReadWithTheTokenOfTheEnvironment) {
  setenv("FORCEBOUND_PAGE_TOKEN", "00112233445566778899aabbccddeeff", 1);
  Server server({"--page", "0"});
  unsetenv("FORCEBOUND_PAGE_TOKEN");
  ASSERT_TRUE(server.wait_for(" with the token of FORCEBOUND_PAGE_TOKEN"));
  EXPECT_THAT(server.out() + server.err(), testing::Not(testing::HasSubstr("00112233"))) << "logs are no place for it";
  std::smatch match;
  const std::string out = server.out();
  ASSERT_TRUE(std::regex_search(out, match, std::regex(R"(http://([0-9.]+):(\d+)/)"))) << out;
  const http::Url url{.host = match[1], .port = match[2], .target = "/metrics?token=00112233445566778899aabbccddeeff"};
  EXPECT_EQ(http::ask(url, {}, 10s).status, 200);
}

/// The lines of a log of JSON, each checked against the one schema.
std::vector<json> lines_of_json(const std::string& text) {
  std::vector<json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const json parsed = json::parse(line, nullptr, false);
    EXPECT_TRUE(parsed.is_object()) << line;
    if (!parsed.is_object()) continue;
    std::set<std::string> keys;
    for (const auto& [key, value] : parsed.items()) keys.insert(key);
    EXPECT_THAT(keys, testing::ElementsAre("level", "pid", "program", "text", "time", "version")) << line;
    EXPECT_THAT(parsed["level"].get<std::string>(), testing::AnyOf("info", "warning", "error"));
    lines.push_back(parsed);
  }
  return lines;
}

TEST(ALogOfJson, IsAllThatClientAndServerWriteToStandardError) {
  Process server(kServer, {"--listen", "127.0.0.1:0", "--scene", "sphere", "--log-json", "--realtime", "--verbose"});
  ASSERT_TRUE(server.wait_for("listening on "));
  const std::string output = server.err();
  std::smatch match;
  ASSERT_TRUE(std::regex_search(output, match, std::regex(R"(listening on ([0-9.]+:\d+))")));
  Client client(match[1], {"--device", "omni", "--duration", "1", "--once", "--log-json"});
  EXPECT_EQ(client.wait(60s), client.expected_end());
  EXPECT_EQ(server.stop(), 0);
  const auto of_client = lines_of_json(client.err());
  const auto of_server = lines_of_json(server.err());
  ASSERT_GE(of_client.size(), 2U);
  ASSERT_GE(of_server.size(), 3U);
  EXPECT_EQ(of_client.front()["program"], "forcebound-client");
  EXPECT_EQ(of_server.front()["program"], "forcebound-server");
  EXPECT_TRUE(std::ranges::any_of(of_server, [](const json& line) {
    return line["text"].get<std::string>().find("connected to scene 'sphere'") != std::string::npos;
  }));
}

TEST(ALogOfJson, HasWhatEndsAProgramToo) {
  const TemporaryFolder folder;
  write_file(folder.file("file.toml"), "log-json = true\nwhat = 1\n");
  for (const Words& words : {Words{"--log-json", "--what"}, Words{"--log-json", "--listen", "nowhere.invalid:1"},
                             Words{"--log-json", "--config", folder.file("file.toml")}}) {
    const Ran ran = run(kServer, words);
    EXPECT_NE(ran.exit_code, 0);
    const auto lines = lines_of_json(ran.err);
    ASSERT_FALSE(lines.empty());
    EXPECT_EQ(lines.back()["level"], "error");
    EXPECT_EQ(lines.back()["program"], "forcebound-server");
    EXPECT_THAT(lines.back()["text"].get<std::string>(), Not(HasSubstr("forcebound-server: ")));
  }
}

}  // namespace
}  // namespace forcebound::test
