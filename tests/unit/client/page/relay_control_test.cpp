#include "forcebound/client/page/relay_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/becomes_true.hpp"

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
  const time::SteadyClock clock;
  RelayControl control("127.0.0.1:" + std::to_string(silent.local_address().port), clock);
  try {
    (void)control.network();
    FAIL() << "a relay answered";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no answer from a relay at 127.0.0.1:"));
  }
}

/// A relay that answers each question.
class AnsweringRelay {
 public:
  explicit AnsweringRelay(const net::Address& at) : link_(net::UdpLink::listen(at)) {}

  [[nodiscard]] net::Address address() const { return link_.local_address(); }

 private:
  void answer(const std::stop_token& ended) {
    const std::array descriptors{link_.descriptor()};
    std::array<std::byte, net::kDatagramBytesMax> buffer{};
    const std::string_view answer = "up: delay 50ms; down: delay 50ms\n";
    while (!ended.stop_requested()) {
      net::wait_readable(descriptors, std::chrono::milliseconds{10});
      while (const auto received = link_.receive(buffer)) link_.send(std::as_bytes(std::span(answer)), received->from);
    }
  }

  net::UdpLink link_;
  std::jthread thread_{[this](const std::stop_token& ended) { answer(ended); }};
};

TEST(RelayControl, FindsARelayByItsNameWhereverThatLeadsAndAgainWhenItHasMoved) {
  struct Names {
    std::mutex mutex;
    std::vector<net::Address> addresses;
  };
  const auto names = std::make_shared<Names>();
  const auto lead_to = [&names](std::vector<net::Address> addresses) {
    const std::scoped_lock lock(names->mutex);
    names->addresses = std::move(addresses);
  };
  const time::SteadyClock clock;
  RelayControl control("relay.example:1", clock, [names](const net::Endpoint&) {
    const std::scoped_lock lock(names->mutex);
    if (names->addresses.empty()) throw std::runtime_error("nobody knows it");
    return names->addresses;
  });
  EXPECT_THAT([&] { (void)control.network(); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("relay.example:1 (nobody knows it)")));

  const net::UdpLink silent = net::UdpLink::listen(net::resolve({"127.0.0.1", 0}));
  std::optional<AnsweringRelay> relay(std::in_place, net::resolve({"127.0.0.2", 0}));
  const auto answers = [&control] {
    try {
      return control.network() == page::Network{.delay_ms = 50};
    } catch (const std::runtime_error&) {  // asked again, as by a user
      return false;
    }
  };
  lead_to({silent.local_address(), relay->address()});
  EXPECT_TRUE(test::becomes_true(answers));
  relay.reset();
  relay.emplace(net::resolve({"127.0.0.3", 0}));
  lead_to({relay->address()});
  EXPECT_TRUE(test::becomes_true(answers));
}

}  // namespace
}  // namespace forcebound::client
