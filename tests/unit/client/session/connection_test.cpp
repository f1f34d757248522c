#include "forcebound/client/session/connection.hpp"

#include <gtest/gtest.h>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

class ConnectionTest : public ::testing::Test {
 protected:
  wire::Welcome welcome(std::uint64_t session) {
    return {.client_nonce = connection.hello(0ms).client_nonce, .session = session};
  }

  static wire::Refusal round_trip_wanted(const wire::Hello& hello) {
    return {.client_nonce = hello.client_nonce,
            .reason = wire::RefusalReason::round_trip_wanted,
            .client_time = hello.client_time};
  }

  using Refused = Connection::Refused;
  Connection connection{{.device = "wall-1dof", .scene = "wall"}, 1};
};

TEST_F(ConnectionTest, SendsHellosWithGrowingPauses) {
  EXPECT_TRUE(connection.hello_due(0ms));
  EXPECT_FALSE(connection.hello_due(99ms));
  EXPECT_TRUE(connection.hello_due(100ms));
  EXPECT_FALSE(connection.hello_due(249ms));
  EXPECT_TRUE(connection.hello_due(250ms));
  for (auto t = 250ms; t < 20s; t += 1ms) (void)connection.hello_due(t);
  int hellos = 0;
  for (auto t = 20'000ms; t < 40'000ms; t += 1ms) hellos += connection.hello_due(t) ? 1 : 0;
  EXPECT_EQ(hellos, 10) << "one in 2 s in the end";
}

TEST_F(ConnectionTest, RequestsTheServerSideLawInItsHello) {
  EXPECT_EQ(connection.hello(0ms).server_law, "");
  Connection with_server_law({.device = "wall-1dof", .scene = "wall", .server_law = "wave"}, 1);
  EXPECT_EQ(with_server_law.hello(0ms).server_law, "wave");
}

TEST_F(ConnectionTest, BeginsASessionOnceHoweverOftenWelcomed) {
  EXPECT_EQ(connection.state(), SessionState::connecting);
  EXPECT_TRUE(connection.on_welcome(welcome(5)));
  EXPECT_FALSE(connection.on_welcome(welcome(5)));
  EXPECT_EQ(connection.session(), 5U);
  EXPECT_EQ(connection.state(), SessionState::active);
  EXPECT_FALSE(connection.hello_due(1h));
}

TEST_F(ConnectionTest, ALateCopyOfAWelcomeDoesNotBringBackTheSessionBefore) {
  EXPECT_TRUE(connection.on_welcome(welcome(5)));
  connection.on_blackout(1s, 250ms, 1s);
  EXPECT_TRUE(connection.on_welcome(welcome(6))) << "the server restarted and answered the same question anew";
  EXPECT_FALSE(connection.on_welcome(welcome(5)));
  EXPECT_EQ(connection.session(), 6U);
  EXPECT_EQ(connection.sessions(), 2U);
}

TEST_F(ConnectionTest, IgnoresAWelcomeMeantForAnother) {
  auto other = welcome(5);
  ++other.client_nonce;
  EXPECT_FALSE(connection.on_welcome(other));
  EXPECT_FALSE(connection.on_welcome({.client_nonce = connection.hello(0ms).client_nonce, .session = 0}));
  EXPECT_EQ(connection.session(), 0U);
}

TEST_F(ConnectionTest, GoesStaleThenReconnectsWithTheSameNonce) {
  connection.on_welcome(welcome(5));
  const auto nonce = connection.hello(0ms).client_nonce;
  connection.on_blackout(300ms, 250ms, 1s);
  EXPECT_EQ(connection.state(), SessionState::stale);
  EXPECT_FALSE(connection.hello_due(10s));
  connection.on_blackout(1s, 250ms, 1s);
  EXPECT_EQ(connection.state(), SessionState::reconnecting);
  EXPECT_EQ(connection.session(), 5U) << "it may still be alive";
  EXPECT_TRUE(connection.hello_due(10s));
  EXPECT_EQ(connection.hello(0ms).client_nonce, nonce);
  connection.on_blackout(0s, 250ms, 1s);
  EXPECT_EQ(connection.state(), SessionState::active);
}

TEST_F(ConnectionTest, TakesANewNonceWhenTheServerDoesNotKnowTheSession) {
  connection.on_welcome(welcome(5));
  const auto old = welcome(6);
  EXPECT_EQ(connection.on_refusal({.session = 4, .reason = wire::RefusalReason::unknown_session}, 0s), Refused::not_us);
  EXPECT_EQ(connection.on_refusal({.session = 5, .reason = wire::RefusalReason::unknown_session}, 0s),
            Refused::session);
  EXPECT_EQ(connection.session(), 0U);
  EXPECT_EQ(connection.state(), SessionState::reconnecting);
  EXPECT_TRUE(connection.hello_due(0s));
  EXPECT_FALSE(connection.on_welcome(old)) << "an answer to the old question";
  EXPECT_TRUE(connection.on_welcome(welcome(7)));
  EXPECT_EQ(connection.sessions(), 2U);
}

TEST_F(ConnectionTest, KeepsAskingAfterARefusal) {
  EXPECT_TRUE(connection.hello_due(0s));
  EXPECT_EQ(connection.on_refusal(
                {.client_nonce = connection.hello(0ms).client_nonce, .reason = wire::RefusalReason::unknown_scene}, 0s),
            Refused::hello);
  EXPECT_TRUE(connection.hello_due(10s));
}

TEST_F(ConnectionTest, AnUnrelatedRefusalDoesNotEndASession) {
  connection.on_welcome(welcome(5));
  EXPECT_EQ(connection.on_refusal(
                {.client_nonce = connection.hello(0ms).client_nonce, .reason = wire::RefusalReason::server_full}, 0s),
            Refused::not_us);
  EXPECT_EQ(connection.session(), 5U);
}

TEST_F(ConnectionTest, TellsTheRoundTripAtOnceToAServerThatWantsIt) {
  EXPECT_TRUE(connection.hello_due(1s));
  const wire::Refusal wanted = round_trip_wanted(connection.hello(1s));
  EXPECT_FALSE(connection.hello_due(1s + 20ms));
  EXPECT_EQ(connection.on_refusal(wanted, 1s + 20ms), Refused::for_now);
  EXPECT_TRUE(connection.hello_due(1s + 20ms));
  EXPECT_EQ(connection.hello(1s + 20ms).round_trip, 20ms);
  (void)connection.on_refusal(wanted, 1s + 90ms);
  EXPECT_FALSE(connection.hello_due(1s + 90ms)) << "a late copy is no news";
  EXPECT_EQ(connection.hello(2s).round_trip, 20ms);
}

TEST_F(ConnectionTest, IgnoresAnImpossibleRoundTrip) {
  wire::Refusal wanted = round_trip_wanted(connection.hello(1s));
  EXPECT_EQ(connection.on_refusal(wanted, 1s - 1ns), Refused::not_us);
  ++wanted.client_nonce;
  EXPECT_EQ(connection.on_refusal(wanted, 2s), Refused::not_us);
  EXPECT_EQ(connection.hello(2s).round_trip, 0s);
}

TEST_F(ConnectionTest, OnlyAHelloThatWasSentMeasuresTheRoundTrip) {
  wire::Refusal wanted = round_trip_wanted(connection.hello(100s));
  wanted.client_time = -wire::kTimeMost;
  EXPECT_EQ(connection.on_refusal(wanted, 100s + 20ms), Refused::not_us);
  wanted.client_time = 100s - 1ns;
  EXPECT_EQ(connection.on_refusal(wanted, 100s + 20ms), Refused::not_us);
  EXPECT_EQ(connection.hello(101s).round_trip, 0s);
  wanted.client_time = 100s;
  EXPECT_EQ(connection.on_refusal(wanted, 100s + Connection::kRoundTripMost + 1ns), Refused::not_us);
  EXPECT_EQ(connection.on_refusal(wanted, 100s + 20ms), Refused::for_now);
  EXPECT_EQ(connection.hello(101s).round_trip, 20ms);
}

TEST_F(ConnectionTest, MeasuresTheRoundTripAnewAfterAHelloWithItFailed) {
  EXPECT_EQ(connection.on_refusal(round_trip_wanted(connection.hello(1s)), 1s + 20ms), Refused::for_now);
  const wire::Hello with = connection.hello(1s + 20ms);
  EXPECT_EQ(with.round_trip, 20ms);
  EXPECT_EQ(connection.on_refusal({.client_nonce = with.client_nonce, .reason = wire::RefusalReason::server_full}, 2s),
            Refused::hello);
  EXPECT_EQ(connection.hello(3s).round_trip, 0s);
}

TEST_F(ConnectionTest, MeasuresTheRoundTripAnewAfterHellosWithItWereNotAnswered) {
  EXPECT_EQ(connection.on_refusal(round_trip_wanted(connection.hello(1s)), 1s + 20ms), Refused::for_now);
  EXPECT_EQ(connection.hello(5s).round_trip, 20ms);
  EXPECT_EQ(connection.hello(20s).round_trip, 0s);
}

TEST_F(ConnectionTest, MeasuresTheRoundTripAnewForEachServer) {
  EXPECT_EQ(connection.on_refusal(round_trip_wanted(connection.hello(1s)), 1s + 20ms), Refused::for_now);
  connection.on_welcome(welcome(5));
  connection.on_bye();
  EXPECT_EQ(connection.hello(2s).round_trip, 0s);
}

TEST_F(ConnectionTest, MeasuresTheRoundTripAnewAfterABlackout) {
  EXPECT_EQ(connection.on_refusal(round_trip_wanted(connection.hello(1s)), 1s + 20ms), Refused::for_now);
  connection.on_welcome(welcome(5));
  connection.on_blackout(2s, 250ms, 1s);
  EXPECT_EQ(connection.hello(4s).round_trip, 0s) << "it may come back by another way";
}

}  // namespace
}  // namespace forcebound::client
