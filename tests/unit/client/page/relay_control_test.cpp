#include "forcebound/client/page/relay_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <string>

#include "forcebound/net/endpoint.hpp"

namespace forcebound::client {
namespace {

TEST(RelayLine, IsInNetemsWords) {
  EXPECT_EQ(relay_line({}), "both");
  EXPECT_EQ(relay_line({.delay_ms = 50}), "both delay 50ms");
  EXPECT_EQ(relay_line({.delay_ms = 50, .jitter_ms = 10, .loss_percent = 2.5}), "both delay 50ms 10ms loss 2.5%");
  EXPECT_EQ(relay_line({.jitter_ms = 10}), "both delay 0ms 10ms");
  EXPECT_EQ(relay_line({.loss_percent = 5}), "both loss 5%");
  EXPECT_EQ(words_of_network({.loss_percent = 5}), "loss 5%");
  EXPECT_EQ(words_of_network({}), "perfect");
}

TEST(RelayAnswer, IsReadAsFarAsItIsDelayJitterAndLoss) {
  EXPECT_EQ(network_of("up: perfect; down: delay 7ms"), page::Network{});
  EXPECT_EQ(network_of("up: delay 50ms 10ms loss 5%; down: perfect"),
            (page::Network{.delay_ms = 50, .jitter_ms = 10, .loss_percent = 5}));
  EXPECT_EQ(network_of("up: loss 1% delay 1s; down: perfect"), (page::Network{.delay_ms = 1000, .loss_percent = 1}));
  EXPECT_EQ(network_of("up: delay 500us loss gemodel 1% 10%; down: perfect"), (page::Network{.delay_ms = 0.5}));
  EXPECT_EQ(network_of("error: expected up, down or both"), std::nullopt);
  EXPECT_EQ(network_of(""), std::nullopt);
}

TEST(RelayAnswer, GivesBackWhatWasAskedFor) {
  const page::Network asked{.delay_ms = 12.5, .jitter_ms = 0.25, .loss_percent = 33};
  const std::string words = relay_line(asked).substr(std::string("both ").size());
  EXPECT_EQ(network_of("up: " + words + "; down: " + words), asked);
}

TEST(RelayControl, SaysThatNoRelayAnswers) {
  const net::UdpLink silent = net::UdpLink::listen(net::resolve({.host = "127.0.0.1", .port = 0}));
  RelayControl control("127.0.0.1:" + std::to_string(silent.local_address().port));
  try {
    (void)control.network();
    FAIL() << "a relay answered";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no answer from a relay at 127.0.0.1:"));
  }
}

}  // namespace
}  // namespace forcebound::client
