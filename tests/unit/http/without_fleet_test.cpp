#include <gmock/gmock.h>

#include <chrono>
#include <stdexcept>

#include "forcebound/http/client.hpp"

namespace forcebound::http {
namespace {

TEST(AProgramWithoutFleets, RefusesEveryRequestAndSaysHowItWasBuilt) {
  EXPECT_THAT(std::string(refusal()), testing::HasSubstr("FORCEBOUND_FLEET=OFF"));
  try {
    (void)ask(parse_url("http://127.0.0.1:9358/ready"), {}, std::chrono::seconds(1));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), "http://127.0.0.1:9358/ready: " + std::string(refusal()));
  }
}

}  // namespace
}  // namespace forcebound::http
