#include "forcebound/net/endpoint.hpp"

#include <gmock/gmock.h>

#include <stdexcept>
#include <vector>

namespace forcebound::net {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Endpoint, ReadsHostAndPort) {
  EXPECT_EQ(parse_endpoint("127.0.0.1:47800"), (Endpoint{"127.0.0.1", 47800}));
  EXPECT_EQ(parse_endpoint("relay.example:0"), (Endpoint{"relay.example", 0}));
  EXPECT_EQ(parse_endpoint("[::1]:65535"), (Endpoint{"::1", 65535}));
}

TEST(Endpoint, RefusesWhatIsNotHostAndPort) {
  for (const char* text : {"", "localhost", ":47800", "localhost:", "localhost:65536", "localhost:-1", "localhost:4x",
                           "::1:47800", "[::1]", "[]:1", "[::1]47800", "a b:1", "localhost: 1"}) {
    EXPECT_THAT([&] { parse_endpoint(text); }, ThrowsMessage<std::invalid_argument>(AllOf(
                                                   HasSubstr("'" + std::string(text) + "'"), HasSubstr("[::1]:47800"))))
        << text;
  }
}

TEST(Endpoint, RefusesPortZeroOfAPeer) {
  EXPECT_EQ(parse_peer("localhost:1"), (Endpoint{"localhost", 1}));
  EXPECT_THAT([] { parse_peer("localhost:0"); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("'localhost:0'"), HasSubstr("from 1 to 65535"))));
  EXPECT_THAT([] { parse_peer("localhost"); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("is not HOST:PORT"), HasSubstr("from 1 to 65535"))));
  EXPECT_THAT([] { parse_endpoint("localhost"); }, ThrowsMessage<std::invalid_argument>(HasSubstr("from 0 to 65535")));
}

TEST(Endpoint, ResolvesNumbersWithoutAskingAnybody) {
  EXPECT_EQ(to_string(resolve({"127.0.0.1", 47800})), "127.0.0.1:47800");
  EXPECT_EQ(to_string(resolve({"::1", 47800})), "[::1]:47800");
}

TEST(Endpoint, IsTriedAtIpv6FirstAndThenAtBothKindsByTurns) {
  const auto of = [](const char* host) { return resolve({host, 1}); };
  const Address a4 = of("192.0.2.1");
  const Address b4 = of("192.0.2.2");
  const Address c4 = of("192.0.2.3");
  const Address a6 = of("2001:db8::1");
  const Address b6 = of("2001:db8::2");
  EXPECT_EQ(in_order_of_trial({a4, b4, a6, c4, b6}), (std::vector{a6, a4, b6, b4, c4}));
  EXPECT_EQ(in_order_of_trial({a4, a4, b4}), (std::vector{a4, b4}));
  EXPECT_EQ(in_order_of_trial({b6, a6, b6}), (std::vector{b6, a6}));
  EXPECT_EQ(in_order_of_trial({}), std::vector<Address>{});
}

TEST(Endpoint, KnowsAnAddressInDigitsFromAName) {
  EXPECT_TRUE(is_numeric({"127.0.0.1", 1}));
  EXPECT_TRUE(is_numeric({"::1", 1}));
  EXPECT_FALSE(is_numeric({"localhost", 1}));
  EXPECT_FALSE(is_numeric({"127.0.0.1.example", 1}));
  EXPECT_EQ(to_string(Endpoint{"::1", 1}), "[::1]:1");
  EXPECT_EQ(to_string(Endpoint{"localhost", 1}), "localhost:1");
}

TEST(Endpoint, ResolvesLocalhostToIpv4) { EXPECT_EQ(to_string(resolve({"localhost", 1})), "127.0.0.1:1"); }

TEST(Endpoint, NamesTheHostThatHasNoAddress) {
  EXPECT_THAT(
      [] {
        resolve({"no such host", 1});
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("cannot find the address of host 'no such host': ")));
}

}  // namespace
}  // namespace forcebound::net
