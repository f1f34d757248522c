// Both ends of encryption on an emulated network, in virtual time.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/client/security/handshaker.hpp"
#include "forcebound/client/security/secure_link.hpp"
#include "forcebound/server/security/secure_link.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/sim/simulated_network.hpp"
#include "tests/tools/sim/virtual_clock.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound {
namespace {

using namespace std::chrono_literals;
using time::Nanoseconds;

/// Sends numbers both ways through sealed datagrams.
class SealedConversation {
 public:
  SealedConversation(const std::string& network, std::uint64_t seed)
      : network_(clock_, {.up = netem::parse_netem(network), .down = netem::parse_netem(network), .seed = seed}),
        random_(seed),
        handshaker_(identity(), fill()),
        client_(network_.add_client(), network_.server_address(), handshaker_, clock_) {
    start_server();
    network_.set_server_handler([this](std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now) {
      const auto content = server_->accept(datagram, from, now);
      while (server_->has_waiting()) server_->answer_waiting(now);
      if (!content) return;
      from_client.insert(number_in(content->bytes));
      server_sent += server_->send(bytes_of(++server_number_), from) ? 1 : 0;
    });
  }

  /// A server that knows nothing of the session before.
  void start_server() {
    server::ServerKeys keys;
    keys.own = security::key_pair_from(security::key_bytes(2));
    keys.shared = security::secret_key(3);
    server_ = std::make_unique<server::SecureLink>(std::move(keys), server::SecureLimits{}, network_.server_link(),
                                                   clock_, fill());
  }

  /// A number from the client each `pause`.
  void run(Nanoseconds duration, Nanoseconds pause = 10ms) {
    next_ = clock_.now();
    for (const Nanoseconds end = clock_.now() + duration; clock_.now() < end; clock_.advance(10ms)) {
      while (const auto received = client_.receive(buffer_)) {
        from_server.insert(number_in(std::span(buffer_).first(received->bytes)));
        ++received_;
      }
      if (clock_.now() >= next_ && client_.ready() && client_.send(bytes_of(client_number_ + 1), {})) {
        ++client_number_;
        next_ = clock_.now() + pause;
      }
      handshaker_.work(clock_.now());
      if (clock_.now() >= timer_) {
        server_->on_timer(clock_.now());
        timer_ = clock_.now() + 100ms;
      }
    }
  }

  [[nodiscard]] const client::SecureLink& client() const { return client_; }
  [[nodiscard]] const server::SecureLink& server() const { return *server_; }
  [[nodiscard]] std::uint64_t client_sent() const { return client_number_; }
  [[nodiscard]] std::uint64_t received() const { return received_; }
  [[nodiscard]] std::string problem() const { return handshaker_.problem(); }

  std::set<std::uint64_t> from_client;
  std::set<std::uint64_t> from_server;
  std::uint64_t server_sent = 0;

 private:
  static client::Identity identity() {
    client::Identity identity{.server = "server:1"};
    identity.own = security::key_pair_from(security::key_bytes(1));
    identity.server_key = security::public_key(2);
    identity.shared = security::secret_key(3);
    return identity;
  }

  std::function<void(std::span<std::byte>)> fill() {
    return [this](std::span<std::byte> bytes) {
      std::ranges::generate(bytes, [this] { return static_cast<std::byte>(random_()); });
    };
  }

  std::span<const std::byte> bytes_of(std::uint64_t number) {
    std::memcpy(content_.data(), &number, sizeof number);
    return content_;
  }

  static std::uint64_t number_in(std::span<const std::byte> content) {
    std::uint64_t number = 0;
    EXPECT_EQ(content.size(), 64U);
    std::memcpy(&number, content.data(), sizeof number);
    return number;
  }

  sim::VirtualClock clock_;
  sim::SimulatedNetwork network_;
  std::mt19937_64 random_;
  client::Handshaker handshaker_;
  client::SecureLink client_;
  std::unique_ptr<server::SecureLink> server_;
  std::array<std::byte, 64> content_{};
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
  std::uint64_t client_number_ = 0;
  std::uint64_t server_number_ = 0;
  std::uint64_t received_ = 0;
  Nanoseconds next_{0};
  Nanoseconds timer_{0};
};

TEST(EncryptionOnANetwork, ChangesKeysWithoutLosingADatagram) {
  SealedConversation conversation("delay 60ms 20ms", 1);
  conversation.run(15min);
  EXPECT_EQ(conversation.client().counters().sessions, 1U);
  EXPECT_GE(conversation.client().counters().rekeys, 6U);
  // But for those that are still on their way.
  EXPECT_GE(conversation.from_client.size() + 10, conversation.client_sent());
  EXPECT_GE(conversation.from_server.size() + 10, conversation.server_sent);
  EXPECT_EQ(conversation.from_server.size(), conversation.received()) << "none twice";
  EXPECT_EQ(conversation.server_sent, conversation.from_client.size()) << "the server could always seal";
}

TEST(EncryptionOnANetwork, ChangesKeysThroughLossDuplicationAndReordering) {
  SealedConversation conversation("delay 100ms 50ms loss 20% duplicate 10%", 2);
  conversation.run(15min);
  EXPECT_EQ(conversation.client().counters().sessions, 1U);
  EXPECT_GE(conversation.client().counters().rekeys, 6U);
  EXPECT_EQ(conversation.from_server.size(), conversation.received()) << "none twice";
  EXPECT_GT(conversation.from_client.size(), conversation.client_sent() * 7 / 10);
  const auto& by_opening = conversation.client().counters().by_opening;
  EXPECT_GT(by_opening[security::Opening::replayed], 100U) << "duplicates are counted as such";
  EXPECT_EQ(by_opening[security::Opening::not_authentic], 0U);
  EXPECT_EQ(by_opening[security::Opening::unknown_key], 0U);
}

TEST(EncryptionOnANetwork, FindsAServerAgainThatWasRestarted) {
  SealedConversation conversation("delay 50ms", 3);
  conversation.run(10s);
  conversation.start_server();
  const std::size_t before = conversation.from_server.size();
  conversation.run(1s);
  EXPECT_EQ(conversation.client().counters().sessions, 2U);
  EXPECT_GT(conversation.from_server.size(), before) << "within a second";
  conversation.run(10s);
  EXPECT_EQ(conversation.client().counters().sessions, 2U);
  EXPECT_EQ(conversation.server().confirmed(), 1U);
  EXPECT_EQ(conversation.problem(), "");
}

// As a client does that the server has no room for: it asks every 2 s. Each session of keys is kept for 80 s, of which
// a server has few.
TEST(EncryptionOnANetwork, KeepsOneSessionOfKeysForAClientThatSendsRarely) {
  for (const char* const network : {"delay 50ms", "delay 150ms 50ms loss 5%", "delay 350ms"}) {
    SealedConversation conversation(network, 4);
    conversation.run(1s);
    for (int i = 0; i < 200 && conversation.problem().empty(); ++i) conversation.run(2s, 2s);
    EXPECT_EQ(conversation.problem(), "") << network;
    EXPECT_EQ(conversation.client().counters().sessions, 1U) << network;
    EXPECT_GE(conversation.client().counters().rekeys, 2U) << network;
    EXPECT_EQ(conversation.server().confirmed(), 1U) << network;
  }
}

// As a client does whose device was unplugged.
TEST(EncryptionOnANetwork, KeepsOneSessionOfKeysThroughPauses) {
  SealedConversation conversation("delay 100ms loss 2%", 5);
  for (int i = 0; i < 20; ++i) {
    conversation.run(2s);
    conversation.run(5s, 1h);
  }
  EXPECT_EQ(conversation.client().counters().sessions, 1U);
  EXPECT_EQ(conversation.server().confirmed(), 1U);
}

}  // namespace
}  // namespace forcebound
