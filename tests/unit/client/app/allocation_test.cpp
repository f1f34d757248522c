#include "forcebound/client/app/allocation.hpp"

#include <gmock/gmock.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace forcebound::client {
namespace {

using testing::HasSubstr;

TEST(AnAllocation, AsksForAServerOfItsFleet) {
  EXPECT_EQ(request_text({}), R"({"namespace":"default"})");
  EXPECT_EQ(request_text({.fleet = "haptics", .name_space = "lab"}),
            R"({"gameServerSelectors":[{"matchLabels":{"agones.dev/fleet":"haptics"}}],"namespace":"lab"})");
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
