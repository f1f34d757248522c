// Who is let in while others do all they can to keep everybody out.

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/unit/server/security/secure_link_fixture.hpp"

namespace forcebound::server {
namespace {

using security::Verdict;

net::Address hostile(std::size_t number) {
  constexpr std::size_t kAddresses = 250;
  net::Address from = at_port(7);
  from.ip[14] = static_cast<std::uint8_t>(10 + number / kAddresses);
  from.ip[15] = static_cast<std::uint8_t>(number % kAddresses);
  return from;
}

/// A server's thread, turn by turn: what has come is taken in, and then one handshake is made.
class Admission : public SecureLinkFixture {
 protected:
  static constexpr Nanoseconds kTurn = 300us;

  void turn() {
    clock.time += kTurn;
    link->answer_waiting(clock.time);
  }

  /// The cookie that the link offers there.
  security::Cookie cookie_at(const net::Address& from) {
    ClientEnd asks = anna_end(1000);
    (void)link->accept(asks.request(), from, clock.time);
    const auto read = security::read_handshake(only_answer());
    return std::get<security::CookieOffer>(read).cookie;
  }

  /// `get_cookie` while others are answered too.
  void get_cookie_quietly(ClientEnd& client, const net::Address& from) {
    sent();
    client.set_cookie({});
    (void)link->accept(client.request(), from, clock.time);
    EXPECT_TRUE(client.accept_offer(only_answer()).has_value());
  }

  static Bytes with_cookie(Bytes request, const security::Cookie& cookie) {
    std::ranges::copy(cookie, request.begin() + security::kHandshakePrologueBytes);
    return request;
  }

  /// What nobody with a key has made.
  Bytes garbage(const security::Cookie& cookie) {
    Bytes message(security::Handshake::overhead(security::Pattern::ik_psk2, 0));
    std::ranges::generate(message, [this] { return static_cast<std::byte>(random_() & 0xffU); });
    Bytes datagram(security::kRequestBytes);
    security::write(
        security::HandshakeRequest{
            .topic = {.client = static_cast<std::uint32_t>(random_() | 1U)}, .cookie = cookie, .message = message},
        datagram);
    return datagram;
  }

  std::vector<security::Cookie> cookies_of(std::size_t sources) {
    std::vector<security::Cookie> cookies;
    for (std::size_t i = 0; i < sources; ++i) cookies.push_back(cookie_at(hostile(i)));
    return cookies;
  }

  /// How many turns pass until the client, which has a cookie, has its answer, with `attack` before each.
  template <class Attack>
  int turns_until_answered(ClientEnd& client, const net::Address& from, const Attack& attack) {
    constexpr int kTurnsMost = 3000;
    constexpr int kPause = 300;
    for (int turns = 0; turns < kTurnsMost; ++turns) {
      attack();
      if (turns % kPause == 0) (void)link->accept(client.request(), from, clock.time);
      turn();
      for (const auto& datagram : sent()) {
        const bool own = datagram.peer == from;
        if (own && client.accept_answer(datagram.bytes, clock.time)) return turns + 1;
      }
    }
    return kTurnsMost;
  }

  std::mt19937_64 random_{1};
};

TEST_F(Admission, IsNotHeldUpByGarbageWithTrueCookiesFrom300Sources) {
  start_with_two();
  const auto cookies = cookies_of(300);
  std::size_t next = 0;
  const auto attack = [&] {  // 10,000 a second
    for (int i = 0; i < 3; ++i, ++next) {
      (void)link->accept(garbage(cookies[next % 300]), hostile(next % 300), clock.time);
    }
  };
  for (int i = 0; i < 1000; ++i) {
    attack();
    turn();
  }
  sent();
  for (std::uint16_t number = 1; number <= 10; ++number) {
    ClientEnd client = number % 2 == 0 ? anna_end(number) : ClientEnd({.own = &bert, .server = &server}, number);
    get_cookie_quietly(client, at_port(number));
    EXPECT_LE(turns_until_answered(client, at_port(number), attack), 5) << number;
    EXPECT_TRUE(link->accept(client.seal("hello", clock.time), at_port(number), clock.time).has_value());
  }
  EXPECT_GT(link->counters().handshakes_not_proven, 3000U);
  EXPECT_EQ(link->counters().handshakes, 10U);
  EXPECT_LE(link->counters().handshakes_not_authentic, 10U + 100U) << "few cost a product on the curve";
}

TEST_F(Admission, GivesRecordedRequestsNoPlaceAfterARestart) {
  start_with_two();
  std::vector<Bytes> recorded;
  for (std::uint32_t i = 0; i < 150; ++i) {
    ClientEnd client = i % 2 == 0 ? anna_end(i + 1) : ClientEnd({.own = &bert, .server = &server}, i + 1);
    get_cookie(client);
    recorded.push_back(client.request());
  }
  start_with_two();
  const auto cookies = cookies_of(200);
  std::size_t next = 0;
  const auto attack = [&] {  // 3,333 a second
    (void)link->accept(with_cookie(recorded[next % 150], cookies[next % 200]), hostile(next % 200), clock.time);
    ++next;
  };
  ClientEnd client = anna_end(1000);
  get_cookie_quietly(client, at_port(1));
  EXPECT_LE(turns_until_answered(client, at_port(1), attack), 5);
  // Its first record comes 200 ms later.
  for (int i = 0; i < 667; ++i) {
    attack();
    turn();
  }
  EXPECT_TRUE(link->accept(client.seal("hello", clock.time), at_port(1), clock.time).has_value());
  EXPECT_EQ(link->unconfirmed(), 0U);
  EXPECT_EQ(link->counters().handshakes, 1U);
  EXPECT_EQ(link->counters().handshakes_not_proven, next);
}

TEST_F(Admission, IsNotHeldUpByRequestsOfOneKeyFrom240Addresses) {
  start_with_two();
  const auto cookies = cookies_of(240);
  ClientEnd client({.own = &bert, .server = &server}, 1000);
  get_cookie_quietly(client, at_port(1));
  std::size_t next = 0;
  const auto attack = [&] {
    for (int i = 0; i < 10 && next < 480; ++i, ++next) {
      ClientEnd stolen = anna_end(static_cast<std::uint32_t>(next + 1));
      stolen.set_cookie(cookies[next % 240]);
      (void)link->accept(stolen.request(), hostile(next % 240), clock.time);
    }
  };
  EXPECT_LE(turns_until_answered(client, at_port(1), attack), 40);
  EXPECT_LE(link->unconfirmed(), 3U) << "two of the key that was stolen";
}

TEST_F(Admission, MakesOneHandshakeAtATimeAndOpensRecordsBefore) {
  start_with_shared_key();
  ClientEnd connected = shared_end(500);
  join(connected, at_port(500));
  std::vector<ClientEnd> asking;
  for (std::uint16_t i = 0; i < 20; ++i) {
    asking.push_back(shared_end(i + 1U));
    get_cookie(asking.back(), hostile(i));
  }
  for (std::uint16_t i = 0; i < 20; ++i) {
    EXPECT_FALSE(link->accept(asking[i].request(), hostile(i), clock.time));
  }
  EXPECT_TRUE(sent().empty()) << "they wait";
  EXPECT_TRUE(link->accept(connected.seal("motion", clock.time), at_port(500), clock.time).has_value());
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(link->has_waiting());
    link->answer_waiting(clock.time);
    EXPECT_EQ(sent().size(), 1U);
  }
  EXPECT_FALSE(link->has_waiting());
}

TEST_F(Admission, HasLaterHandshakesWaitToo) {
  start_with_list();
  ClientEnd client = anna_end();
  join(client);
  client.begin(2);
  EXPECT_FALSE(link->accept(client.seal(client.later_request(), clock.time), at_port(1), clock.time));
  EXPECT_TRUE(sent().empty());
  EXPECT_TRUE(link->accept(client.seal("motion", clock.time), at_port(1), clock.time).has_value());
  link->answer_waiting(clock.time);
  EXPECT_EQ(sent().size(), 1U);
  EXPECT_EQ(link->counters().handshakes_later, 1U);
}

TEST_F(Admission, OfAClientWaitsWhileTwoOfItsRequestsAreNotConfirmed) {
  start_with_list();
  std::array clients{anna_end(1), anna_end(2), anna_end(3)};
  EXPECT_TRUE(shake_hands(clients[0], at_port(1)).has_value());
  EXPECT_TRUE(shake_hands(clients[1], at_port(2)).has_value());
  get_cookie(clients[2], at_port(3));
  arrive(clients[2].request(), at_port(3));
  EXPECT_TRUE(sent().empty());
  EXPECT_EQ(link->counters().handshakes_crowded, 1U);
  EXPECT_TRUE(arrive(clients[0].seal("hello", clock.time), at_port(1)).has_value());
  arrive(clients[2].request(), at_port(3));
  EXPECT_TRUE(clients[2].accept_answer(only_answer(), clock.time).has_value());
}

TEST_F(Admission, TellsFewOfThoseThatItCannotLetInWhy) {
  start_with_list();
  const auto cookies = cookies_of(50);
  ClientEnd stranger({.own = &bert, .server = &server}, 9);
  sent();
  for (int i = 0; i < 3333; ++i) {  // in a second
    stranger.set_cookie(cookies[static_cast<std::size_t>(i) % 50]);
    (void)link->accept(stranger.request(), hostile(static_cast<std::size_t>(i) % 50), clock.time);
    turn();
  }
  EXPECT_LE(sent().size(), 110U);
  EXPECT_GE(link->counters().handshakes_not_allowed, 10U);
  EXPECT_EQ(link->unconfirmed(), 0U);
}

TEST_F(Admission, IsNotEndedByACopyOfTheRequestWithItsProofSpoilt) {
  start({.own = security::key_pair_from(security::key_bytes(2)), .shared = security::secret_key(3)});
  ClientEnd client({.own = &bert, .server = &server, .shared = &shared}, 1);
  get_cookie(client);
  Bytes spoilt = client.request();
  spoilt[security::kHandshakePrologueBytes + security::kCookieBytes + security::kProofBytes] ^= std::byte{1};
  arrive(spoilt);
  EXPECT_FALSE(client.accept_answer(only_answer(), clock.time)) << "who reads it would take itself for refused";
  arrive(client.request());
  EXPECT_EQ(client.accept_answer(only_answer(), clock.time)->verdict, Verdict::let_in);
}

TEST_F(Admission, OfWhoIsNewInTheListFollowsItAndOfWhoIsGoneEnds) {
  start_with_list();
  ClientEnd client({.own = &bert, .server = &server}, 5);
  EXPECT_EQ(shake_hands(client)->verdict, Verdict::not_allowed);
  link->replace_clients(security::AllowedClients::parse(
      "[[client]]\nname = \"anna\"\npublic_key = \"" + security::public_text(4) + "\"\n", "clients.toml"));
  client.begin(1);
  EXPECT_EQ(shake_hands(client)->verdict, Verdict::let_in);
  ClientEnd before = anna_end(6);
  EXPECT_EQ(shake_hands(before, at_port(2))->verdict, Verdict::not_allowed);
}

TEST_F(Admission, BySharedKeyTakesTheOldestPlaceOfTheSourceThatHasMost) {
  start_with_shared_key();
  ClientEnd far = shared_end(1);
  ASSERT_TRUE(shake_hands(far, at_port(1)).has_value());
  for (std::uint32_t i = 0; i < 2 * SecureLink::kUnconfirmedMost; ++i) {
    ClientEnd client = shared_end(i + 2);
    clock.time += 50ms;
    ASSERT_TRUE(shake_hands(client, hostile(i % 8)).has_value()) << i;
  }
  EXPECT_TRUE(arrive(far.seal("hello", clock.time), at_port(1)).has_value()) << "the oldest, but of another source";
}

}  // namespace
}  // namespace forcebound::server
