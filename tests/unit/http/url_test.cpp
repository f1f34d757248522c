#include <gmock/gmock.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/http/client.hpp"

namespace forcebound::http {
namespace {

using testing::HasSubstr;

TEST(AUrl, IsReadInItsParts) {
  const Url plain = parse_url("http://127.0.0.1:9358/ready");
  EXPECT_FALSE(plain.encrypted);
  EXPECT_EQ(plain.host, "127.0.0.1");
  EXPECT_EQ(plain.port, "9358");
  EXPECT_EQ(plain.target, "/ready");
  const Url encrypted = parse_url("https://allocator.example.org");
  EXPECT_TRUE(encrypted.encrypted);
  EXPECT_EQ(encrypted.port, "443");
  EXPECT_EQ(encrypted.target, "/");
  EXPECT_EQ(parse_url("http://[::1]:80/x").host, "::1");
}

TEST(AUrl, IsWrittenAsItIsRead) {
  for (const std::string text : {"http://127.0.0.1:9358/ready", "https://a.example:443/", "http://[::1]:8080/a/b"}) {
    EXPECT_EQ(parse_url(text).text(), text);
  }
}

TEST(AUrl, NamesItsHostAndPortWithAnIpv6AddressInBrackets) {
  EXPECT_EQ(parse_url("http://127.0.0.1:9358/ready").authority(), "127.0.0.1:9358");
  EXPECT_EQ(parse_url("http://[::1]/").authority(), "[::1]:80");
}

TEST(AUrl, IsRefusedWithTheReason) {
  struct Case {
    std::string text;
    std::string why;
  };
  const std::vector<Case> cases{{"allocator:443", "begins with neither http:// nor https://"},
                                {"http://", "it has no host"},
                                {"http://user@host/", "it has no host"},
                                {"http://host:0/", "got '0'"},
                                {"http://host:65536/", "got '65536'"},
                                {"http://host:/", "got ''"},
                                {"http://[::1/", "bracket"},
                                {"http://[::1]80/", "it has no host"},
                                {"http://host/a b", "space"},
                                {"http://host/\r\nX: y", "control character"}};
  for (const auto& [text, why] : cases) {
    try {
      (void)parse_url(text);
      ADD_FAILURE() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(why)) << text;
      EXPECT_THAT(error.what(), HasSubstr("accepted is http://HOST")) << text;
    }
  }
}

}  // namespace
}  // namespace forcebound::http
