#include "forcebound/net/endpoint.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

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
