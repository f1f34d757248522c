#include "forcebound/server/runtime/embedded_server.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

/// Of no client.
EnvironmentKind none() {
  return {.name = "none", .make = [](const ClientFacts& /*client*/) { return MadeEnvironment{}; }};
}

TEST(EmbeddedServer, NamesWhatIsRefusedAsItsUserWroteIt) {
  const auto serve = [](const char* listen, bool by_options) {
    return [=] { (void)EmbeddedServer({.listen = listen, .by_options = by_options}, none(), "nothing"); };
  };
  EXPECT_THAT(serve("0.0.0.0:0", false),
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("'shared_key'"), Not(HasSubstr("--")))));
  EXPECT_THAT(serve("0.0.0.0:0", true),
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("--psk"), Not(HasSubstr("shared_key")))));
}

TEST(EmbeddedServer, RunsOnceAndSaysSo) {
  // A priority that the system refuses, as it does without privileges, changes nothing.
  EmbeddedServer server({.listen = "127.0.0.1:0", .priority = 40}, none(), "nothing");
  EXPECT_EQ(server.encryption_in_words(), "not encrypted: this machine only");
  EXPECT_EQ(server.stop(), EmbeddedServer::Stopped::never_started);
  EXPECT_TRUE(server.start());
  EXPECT_FALSE(server.start());
  EXPECT_TRUE(server.is_running());
  EXPECT_EQ(server.stop(), EmbeddedServer::Stopped::now);
  EXPECT_FALSE(server.is_running());
}

}  // namespace
}  // namespace forcebound::server
