#include "tests/unit/server/security/secure_link_fixture.hpp"

namespace forcebound::server {
namespace {

using security::Opening;
using security::Verdict;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Pair;

class Handshakes : public SecureLinkFixture {};

TEST_F(Handshakes, NeedAKeyPairOrASharedKey) { EXPECT_THROW(start({}), std::invalid_argument); }

TEST_F(Handshakes, BeginWithACookieThatLeavesNothingBehindAndSaysTheServersKey) {
  start_with_list();
  ClientEnd client = anna_end();
  EXPECT_FALSE(arrive(client.request()));
  const Bytes offer = only_answer();
  EXPECT_EQ(offer.size(), security::kCookieOfferBytes);
  EXPECT_EQ(client.accept_offer(offer), server);
  EXPECT_EQ(link->confirmed() + link->unconfirmed(), 0U);
  EXPECT_EQ(link->counters().cookies_offered, 1U);
}

TEST_F(Handshakes, OfASharedKeyOfferNoPublicKey) {
  start_with_shared_key();
  ClientEnd client = shared_end();
  EXPECT_FALSE(arrive(client.request()));
  EXPECT_EQ(client.accept_offer(only_answer()), security::PublicKey{});
}

TEST_F(Handshakes, WithTheCookieGiveKeysThatTheFirstRecordConfirms) {
  start_with_list();
  ClientEnd client = anna_end();
  const auto admission = shake_hands(client);
  ASSERT_TRUE(admission.has_value());
  EXPECT_EQ(admission->verdict, Verdict::let_in);
  EXPECT_EQ(link->unconfirmed(), 1U);
  EXPECT_EQ(link->confirmed(), 0U);
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(1))) << "who asked may have repeated another one's request";
  EXPECT_THAT(*arrive(client.seal("motion", clock.time)), Pair("motion", "anna"));
  EXPECT_EQ(link->unconfirmed(), 0U);
  EXPECT_EQ(link->confirmed(), 1U);
  EXPECT_EQ(received_by(client, "force", at_port(1)), "force");
}

TEST_F(Handshakes, OfASharedKeyTellTheServerNobodysName) {
  start_with_shared_key();
  ClientEnd client = shared_end();
  ASSERT_TRUE(shake_hands(client).has_value());
  EXPECT_THAT(*arrive(client.seal("motion", clock.time)), Pair("motion", ""));
}

TEST_F(Handshakes, WithAKeyPairAndASharedKeyLetInWhoHasTheSharedKey) {
  start({.own = security::key_pair_from(security::key_bytes(2)), .shared = security::secret_key(3)});
  ClientEnd knows({.own = &bert, .server = &server, .shared = &shared}, 1);
  EXPECT_EQ(shake_hands(knows)->verdict, Verdict::let_in);
  const security::SecretKey wrong = security::secret_key(9);
  ClientEnd guesses({.own = &bert, .server = &server, .shared = &wrong}, 2);
  EXPECT_FALSE(shake_hands(guesses).has_value()) << "the answer is sealed with the shared key too";
}

TEST_F(Handshakes, OfACookieFromAnotherAddressGetACookieAgain) {
  start_with_list();
  ClientEnd client = anna_end();
  get_cookie(client);
  for (const net::Address& elsewhere : {at_port(2), net::Address{.ip = {1}, .port = 1}}) {
    EXPECT_FALSE(arrive(client.request(), elsewhere));
    EXPECT_EQ(only_answer().size(), security::kCookieOfferBytes);
  }
  EXPECT_EQ(link->unconfirmed(), 0U);
}

TEST_F(Handshakes, GiveACopyOfARequestTheSameAnswerAndNoSecondKeys) {
  start_with_list();
  ClientEnd client = anna_end();
  get_cookie(client);
  const Bytes request = client.request();
  arrive(request);
  const Bytes answer = only_answer();
  for (int i = 0; i < 20; ++i) {
    arrive(request);
    EXPECT_EQ(only_answer(), answer);
  }
  EXPECT_EQ(link->unconfirmed(), 1U);
  EXPECT_EQ(link->counters().handshakes, 1U);
  EXPECT_EQ(link->counters().handshakes_again, 20U);
  for (int i = 0; i < 100; ++i) arrive(request);
  EXPECT_EQ(sent().size(), 9U) << "thirty at once";
  clock.time += 10s;
  ASSERT_TRUE(client.accept_answer(answer, clock.time).has_value());
  EXPECT_TRUE(arrive(client.seal("motion", clock.time)).has_value());
  arrive(request);
  EXPECT_EQ(only_answer(), answer) << "a late copy";
  EXPECT_EQ(link->confirmed() + link->unconfirmed(), 1U);
}

TEST_F(Handshakes, OfACopyFromElsewhereGiveNoKeysOfItsOwnEither) {
  start_with_list();
  ClientEnd client = anna_end();
  get_cookie(client);
  Bytes request = client.request();
  arrive(request);
  sent();
  // Whoever has recorded it has a cookie for an address of its own.
  ClientEnd records = anna_end(99);
  get_cookie(records, at_port(9));
  const Bytes own = records.request();
  std::copy_n(own.begin() + security::kHandshakePrologueBytes, security::kCookieBytes,
              request.begin() + security::kHandshakePrologueBytes);
  arrive(request, at_port(9));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(link->unconfirmed(), 1U);
  EXPECT_EQ(link->counters().handshakes_not_proven, 1U);
}

TEST_F(Handshakes, TellAClientThatIsNotListedSoAndKeepNothing) {
  start_with_list();
  ClientEnd client({.own = &bert, .server = &server}, 5);
  const auto admission = shake_hands(client);
  ASSERT_TRUE(admission.has_value());
  EXPECT_EQ(*admission, (security::Admission{.verdict = Verdict::not_allowed, .server = 0}));
  EXPECT_EQ(link->confirmed() + link->unconfirmed(), 0U);
  EXPECT_EQ(link->counters().handshakes_not_allowed, 1U);
  EXPECT_THAT(refusals.lines, ElementsAre(HasSubstr(security::public_text(4))));
}

TEST_F(Handshakes, AreNotAnsweredToWhoHasAnotherKey) {
  start_with_shared_key();
  const security::SecretKey wrong = security::secret_key(9);
  ClientEnd guesses({.shared = &wrong}, 5);
  get_cookie(guesses);
  arrive(guesses.request());
  start_with_list();
  const security::PublicKey another = security::public_key(9);
  ClientEnd mistaken({.own = &anna, .server = &another}, 5);
  get_cookie(mistaken);
  arrive(mistaken.request());
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(link->counters().handshakes_not_authentic, 1U);
  EXPECT_EQ(link->unconfirmed(), 0U);
}

TEST_F(Handshakes, OfAnotherPatternAreToldTheServersOwn) {
  start_with_list();
  arrive(shared_end().request());
  const auto answers = sent();
  ASSERT_EQ(answers.size(), 1U);
  const auto read = security::read_handshake(answers[0].bytes);
  ASSERT_TRUE(std::holds_alternative<security::CookieOffer>(read));
  EXPECT_EQ(std::get<security::CookieOffer>(read).topic.pattern, security::Pattern::ik_psk2);
  EXPECT_EQ(link->unconfirmed(), 0U);
}

TEST_F(Handshakes, OfAnotherLengthAreDropped) {
  start_with_list();
  ClientEnd client = anna_end();
  arrive(client.later_request());
  Bytes longer = client.request();
  longer.emplace_back();
  arrive(longer);
  arrive(std::span(longer).first(security::kHandshakePrologueBytes));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(link->counters().handshakes_malformed, 3U);
}

TEST_F(Handshakes, WithAnyBitOfTheRequestFlippedGiveNoKeys) {
  start_with_list();
  ClientEnd client = anna_end();
  // Without a shared key nothing is proven by one.
  constexpr std::size_t kUnusedAt = security::kHandshakePrologueBytes + security::kCookieBytes + security::kProofBytes;
  for (std::size_t bit = 0; bit < 8 * client.later_request().size(); ++bit) {
    if (bit / 8 >= kUnusedAt && bit / 8 < kUnusedAt + security::kProofBytes) continue;
    clock.time += 1s;  // so that even what is not proven is looked at
    get_cookie(client);
    Bytes flipped = client.request();
    flipped[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(arrive(flipped)) << bit;
    for (const auto& answer : sent()) EXPECT_FALSE(client.accept_answer(answer.bytes, clock.time)) << bit;
    ASSERT_EQ(link->unconfirmed(), 0U) << bit;
  }
  get_cookie(client);
  arrive(client.request());
  EXPECT_TRUE(client.accept_answer(only_answer(), clock.time).has_value()) << "the flips did no harm";
}

TEST_F(Handshakes, WithAnyBitOfTheAnswerFlippedGiveTheClientNoKeys) {
  start_with_list();
  ClientEnd client = anna_end();
  get_cookie(client);
  arrive(client.request());
  const Bytes answer = only_answer();
  for (std::size_t bit = 0; bit < 8 * answer.size(); ++bit) {
    Bytes flipped = answer;
    flipped[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(client.accept_answer(flipped, clock.time)) << bit;
  }
  EXPECT_TRUE(client.accept_answer(answer, clock.time).has_value());
}

TEST_F(Handshakes, ThatAreNotUsedTakeBoundedRoomAndAreForgotten) {
  start_with_shared_key();
  std::vector<ClientEnd> clients;
  clients.reserve(200);
  for (std::uint32_t i = 0; i < 200; ++i) {
    clients.push_back(shared_end(i + 1));
    clock.time += 100ms;
    ASSERT_TRUE(shake_hands(clients.back(), at_port(static_cast<std::uint16_t>(i + 1))).has_value());
    ASSERT_LE(link->unconfirmed(), SecureLink::kUnconfirmedMost);
  }
  EXPECT_EQ(link->counters().handshakes_unused, 200U - SecureLink::kUnconfirmedMost);
  EXPECT_FALSE(arrive(clients.front().seal("motion", clock.time))) << "the oldest went first";
  EXPECT_TRUE(arrive(clients.back().seal("motion", clock.time)).has_value());
  clock.time += SecureLink::kUnconfirmedKept;
  link->on_timer(clock.time);
  EXPECT_EQ(link->unconfirmed(), 0U);
  EXPECT_EQ(link->confirmed(), 1U);
}

TEST_F(Handshakes, AreRefusedWhereThereAreKeysForAsManyAsThereMayBe) {
  const SecureLimits limits{.sessions_max = 1};
  start_with_list(limits);
  for (std::uint32_t i = 0; i < limits.confirmed_most(); ++i) {
    ClientEnd client = anna_end(i + 1);
    clock.time += 20ms;
    join(client, at_port(static_cast<std::uint16_t>(i + 1)));
  }
  EXPECT_EQ(link->confirmed(), limits.confirmed_most());
  ClientEnd late = anna_end(100);
  const auto admission = shake_hands(late, at_port(100));
  ASSERT_TRUE(admission.has_value());
  EXPECT_EQ(*admission, (security::Admission{.verdict = Verdict::full, .server = 0}));
  EXPECT_EQ(link->counters().handshakes_full, 1U);
  EXPECT_EQ(link->unconfirmed(), 0U);
}

TEST_F(Handshakes, OfAClientWithAMostOfSessionsTakeThePlaceOfItsOwnAlone) {
  start_with_list({.sessions_max = 64}, "sessions_max = 1\n");
  const std::size_t most = SecureLimits::confirmed_most_of(1);
  std::vector<ClientEnd> clients;
  for (std::uint32_t i = 0; i < most + 5; ++i) {
    clients.push_back(anna_end(i + 1));
    clock.time += 20ms;
    join(clients.back(), at_port(static_cast<std::uint16_t>(i + 1)));
    // One that is heard keeps its place.
    ASSERT_TRUE(arrive(clients.front().seal("motion", clock.time)).has_value()) << i;
  }
  EXPECT_EQ(link->confirmed(), most);
  EXPECT_FALSE(arrive(clients[1].seal("motion", clock.time), at_port(2)).has_value()) << "silent longest";
  EXPECT_TRUE(arrive(clients.back().seal("motion", clock.time), at_port(20)).has_value());
}

TEST_F(Handshakes, ThatAreConfirmedAllInOneInstantForgetNoneThatIsInUse) {
  start_with_list({.sessions_max = 64}, "sessions_max = 1\n");
  const std::size_t most = SecureLimits::confirmed_most_of(1);
  std::vector<ClientEnd> clients;
  for (std::uint32_t i = 0; i < 2 * most; ++i) {
    clients.push_back(anna_end(i + 1));
    join(clients.back(), at_port(static_cast<std::uint16_t>(i + 1)));
    ASSERT_TRUE(
        arrive(clients.back().seal("motion", clock.time), at_port(static_cast<std::uint16_t>(i + 1))).has_value());
  }
  EXPECT_EQ(link->confirmed(), most);
}

TEST_F(Handshakes, WhereThereIsNoRoomTakeItFromWhoHasMost) {
  const SecureLimits limits{.sessions_max = 4};
  start_with_two(limits);
  for (std::uint32_t i = 0; i < limits.confirmed_most(); ++i) {
    ClientEnd client = anna_end(i + 1);
    clock.time += 100ms;
    join(client, at_port(static_cast<std::uint16_t>(i + 1)));
  }
  ClientEnd other({.own = &bert, .server = &server}, 100);
  clock.time += 100ms;
  join(other, at_port(100));
  EXPECT_EQ(link->confirmed(), limits.confirmed_most());
  ClientEnd again = anna_end(101);
  clock.time += 100ms;
  EXPECT_EQ(shake_hands(again, at_port(101))->verdict, Verdict::full) << "anna has most herself";
}

TEST_F(Handshakes, ByASharedKeyAreLimitedForEachSource) {
  start_with_shared_key();
  for (std::uint32_t i = 0; i < 120; ++i) {
    ClientEnd client = shared_end(i + 1);
    get_cookie(client);
    arrive(client.request());
    sent();
  }
  EXPECT_EQ(link->counters().handshakes, 30U);
  EXPECT_EQ(link->counters().handshakes_over_rate, 90U);
}

TEST_F(Handshakes, ShowNoSecretInWhatIsSentOrSaid) {
  start({.own = security::key_pair_from(security::key_bytes(2)), .shared = security::secret_key(3)});
  ClientEnd client({.own = &anna, .server = &server, .shared = &shared}, 1);
  std::string all;
  arrive(client.request());
  const auto collect = [&] {
    for (const auto& datagram : inner.sent) {
      all.append(reinterpret_cast<const char*>(datagram.bytes.data()), datagram.bytes.size());
    }
  };
  collect();
  client.accept_offer(only_answer());
  arrive(client.request());
  collect();
  all += link->counters().text();
  for (const std::string& line : refusals.lines) all += line;
  for (const std::uint8_t number : {std::uint8_t{2}, std::uint8_t{3}}) {
    const auto key = security::key_bytes(number);
    EXPECT_THAT(all, Not(HasSubstr(std::string(reinterpret_cast<const char*>(key.data()), key.size()))));
    EXPECT_THAT(all, Not(HasSubstr(security::to_base64(key))));
  }
}

/// A session whose client wants another key.
class LaterHandshakes : public SecureLinkFixture {
 protected:
  void SetUp() override {
    start_with_list();
    join(client);
  }

  /// The client asks, and has not heard the answer.
  Bytes ask() {
    EXPECT_FALSE(arrive(client.seal(client.later_request(), clock.time)));
    return only_answer();
  }

  ClientEnd client = anna_end();
};

TEST_F(LaterHandshakes, ChangeTheKeyWithoutLosingARecordOfEitherWay) {
  for (std::uint8_t handshake = 2; handshake < 6; ++handshake) {
    clock.time += security::kRekeyAfter;
    client.begin(handshake);
    const Bytes early = client.seal("early", clock.time);
    const Bytes answer = ask();
    const Bytes meanwhile = client.seal("meanwhile", clock.time);
    EXPECT_EQ(received_by(client, "old key", at_port(1)), "old key") << "the client need not have the answer yet";
    const auto content = client.open(answer, clock.time);
    ASSERT_TRUE(content.has_value());
    ASSERT_TRUE(client.accept_answer(*content, clock.time).has_value());
    EXPECT_EQ(received_by(client, "before", at_port(1)), "before");
    EXPECT_THAT(*arrive(client.seal("new key", clock.time)), Pair("new key", "anna"));
    EXPECT_EQ(received_by(client, "after", at_port(1)), "after");
    EXPECT_THAT(*arrive(meanwhile), Pair("meanwhile", "anna"));
    EXPECT_THAT(*arrive(early), Pair("early", "anna"));
  }
  EXPECT_EQ(link->counters().handshakes_later, 4U);
  EXPECT_EQ(records(Opening::not_authentic) + records(Opening::unknown_key), 0U);
}

TEST_F(LaterHandshakes, GiveACopyOfTheRequestTheSameAnswer) {
  client.begin(2);
  const auto first = client.open(ask(), clock.time);
  const auto second = client.open(ask(), clock.time);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(*first, *second);
  ASSERT_TRUE(client.accept_answer(*first, clock.time).has_value());
  EXPECT_TRUE(arrive(client.seal("new key", clock.time)).has_value());
  EXPECT_EQ(link->counters().handshakes_again, 1U);
}

TEST_F(LaterHandshakes, OfAnotherClientsKeyAreDropped) {
  ClientEnd another({.own = &bert, .server = &server}, 11);
  another.begin(2);
  EXPECT_FALSE(arrive(client.seal(another.later_request(), clock.time)));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(link->counters().handshakes_not_allowed, 1U);
}

TEST_F(LaterHandshakes, OfAnotherSessionsNumberAreDropped) {
  ClientEnd another = anna_end(12);
  another.begin(2);
  EXPECT_FALSE(arrive(client.seal(another.later_request(), clock.time)));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(link->counters().handshakes_malformed, 1U);
}

TEST_F(LaterHandshakes, AreLimited) {
  for (int i = 0; i < 20; ++i) {
    client.begin(2);
    EXPECT_FALSE(arrive(client.seal(client.later_request(), clock.time)));
  }
  EXPECT_EQ(link->counters().handshakes_later, 5U);
  EXPECT_EQ(link->counters().handshakes_over_rate, 15U);
}

TEST_F(LaterHandshakes, AreMissedByAKeyThatExpires) {
  clock.time += security::kKeyExpiresAfter;
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(1)));
  link->on_timer(clock.time);
  EXPECT_EQ(link->confirmed(), 0U);
}

}  // namespace
}  // namespace forcebound::server
