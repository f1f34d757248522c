#include "forcebound/client/app/allocation.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace forcebound::client {
namespace {

using testing::HasSubstr;

TEST(AnAllocation, AsksForAServerInUseWithPlacesLeftBeforeOneThatWaits) {
  const auto request = nlohmann::json::parse(request_text({.fleet = "haptics", .name_space = "lab"}));
  EXPECT_EQ(request["namespace"], "lab");
  ASSERT_EQ(request["gameServerSelectors"].size(), 2);
  const auto& in_use = request["gameServerSelectors"][0];
  const auto& waiting = request["gameServerSelectors"][1];
  EXPECT_EQ(in_use["gameServerState"], "ALLOCATED");
  EXPECT_EQ(in_use["counters"]["sessions"]["minAvailable"], "1");
  EXPECT_EQ(waiting["gameServerState"], "READY");
  for (const auto& selector : {in_use, waiting}) EXPECT_EQ(selector["matchLabels"]["agones.dev/fleet"], "haptics");
  EXPECT_EQ(request["counters"]["sessions"]["action"], "Increment");
  EXPECT_TRUE(nlohmann::json::parse(request_text({}))["gameServerSelectors"][0]["matchLabels"].empty());
}

TEST(AnAllocation, TakesThePortThatIsNamedForceboundElseTheFirst) {
  EXPECT_EQ(server_of({200, R"({"address":"10.1.2.3","ports":[{"name":"default","port":7463}]})"}), "10.1.2.3:7463");
  EXPECT_EQ(
      server_of({200, R"({"address":"10.1.2.3","ports":[{"name":"page","port":1},{"name":"forcebound","port":2}]})"}),
      "10.1.2.3:2");
  EXPECT_EQ(server_of({200, R"({"address":"2001:db8::1","ports":[{"name":"forcebound","port":9}]})"}),
            "[2001:db8::1]:9");
}

TEST(AnAllocation, SaysWhatTheAllocatorSaidInstead) {
  const std::vector<std::pair<http::Response, std::string>> cases{
      {{429, R"({"code":8,"message":"there is no available GameServer to allocate"})"},
       "HTTP status 429: there is no available GameServer to allocate"},
      {{500, "\x1b[31moh\n"}, "HTTP status 500: "},
      {{200, "not JSON"}, "no address and port: not JSON"},
      {{200, R"({"address":"10.1.2.3","ports":[]})"}, "no address and port"},
      {{200, R"({"address":"10.1.2.3","ports":[{"name":"a"}]})"}, "no address and port"},
      {{200, R"({"address":7,"ports":[{"name":"a","port":1}]})"}, "no address and port"},
      {{200, R"({"address":"10.1.2.3","ports":[7]})"}, "no address and port"},
      {{200, R"({"address":"10.1.2.3","ports":[{"name":"a","port":-1}]})"}, "no address and port"},
      {{200, R"({"address":"10.1.2.3","ports":[{"name":"a","port":70000}]})"}, "names no server"}};
  for (const auto& [answer, why] : cases) {
    try {
      (void)server_of(answer);
      ADD_FAILURE() << answer.body;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(why)) << answer.body;
      EXPECT_EQ(std::string(error.what()).find('\x1b'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace forcebound::client
