#include "forcebound/client/security/secure_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "forcebound/client/security/handshaker.hpp"
#include "forcebound/text/file.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_link.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/client/security/server_end.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr net::Address kServer{.ip = {1}, .port = 1};
constexpr net::Address kOther{.ip = {2}, .port = 2};

Bytes content(std::uint8_t number) { return Bytes(100, std::byte{number}); }

Identity identity_with(const security::PublicKey& server) {
  Identity identity{.server = "haptics:47800"};
  identity.own = security::key_pair_from(security::key_bytes(1));
  identity.server_key = server;
  identity.shared = security::secret_key(3);
  return identity;
}

/// A client's link and its handshaker, with a server that answers when the test says so.
class SecureLinkTest : public testing::Test {
 protected:
  void begin(Identity identity) {
    handshaker_ = std::make_unique<Handshaker>(std::move(identity), [this](std::span<std::byte> bytes) {
      std::ranges::generate(bytes, [this] { return static_cast<std::byte>(random_()); });
    });
    secure_ = std::make_unique<SecureLink>(link_, kServer, *handshaker_, clock_);
  }
  void begin() { begin(identity_with(server_.own.public_key)); }

  /// One tick: what was received, and the handshaker's turn.
  std::vector<Bytes> tick() {
    clock_.time += 1ms;
    std::vector<Bytes> contents;
    while (const auto received = secure_->receive(buffer_)) {
      contents.push_back(bytes_of(std::span(buffer_).first(received->bytes)));
    }
    handshaker_->work(clock_.time);
    return contents;
  }

  /// What was sent since the last call.
  std::vector<Bytes> sent() {
    std::vector<Bytes> all;
    for (const auto& datagram : std::exchange(link_.sent, {})) all.push_back(datagram.bytes);
    return all;
  }

  /// Ticks until something is sent, and takes the newest.
  Bytes next_sent(time::Nanoseconds patience = 3s) {
    for (const auto until = clock_.time + patience; clock_.time < until;) {
      tick();
      if (auto all = sent(); !all.empty()) return all.back();
    }
    ADD_FAILURE() << "nothing was sent";
    return {};
  }

  void from_server(std::span<const std::byte> datagram) { link_.arrive(datagram, kServer); }

  /// The request with Noise's message, after the server has offered a cookie.
  security::HandshakeRequest request() {
    from_server(server_.offer_for(ServerEnd::request_in(next_sent())));
    sent_ = next_sent();
    return ServerEnd::request_in(sent_);
  }

  void shake_hands() {
    from_server(server_.answer_to(request(), clock_.time));
    tick();
    tick();
    // The server has to see the first record before it may seal.
    EXPECT_TRUE(secure_->ready());
    (void)sent();
    EXPECT_TRUE(secure_->send(content(1), kServer));
    EXPECT_EQ(server_.opened(sent().back(), clock_.time), content(1));
  }

  /// As many as have to be unanswered.
  void send_unanswered() {
    for (int i = 0; i < SecureLink::kUnansweredLeast; ++i) EXPECT_TRUE(secure_->send(content(2), kServer));
    (void)sent();
  }

  void receive() {
    from_server(server_.sealed(content(9), clock_.time));
    EXPECT_EQ(tick(), std::vector<Bytes>{content(9)});
  }

  /// A session that the server has spoken in, and in which it has been silent until another is wanted.
  void begin_and_lose_the_server() {
    begin();
    shake_hands();
    receive();
    send_unanswered();
    clock_.time += SecureLink::kSilence;
  }

  /// Has another server answer the request, which knows nothing of the session before.
  void answer_as_restarted(const security::HandshakeRequest& asked) {
    restarted_.number = 33;
    from_server(restarted_.answer_to(asked, clock_.time));
  }

  /// Lets the server speak often enough meanwhile.
  void pass(time::Nanoseconds duration) {
    for (const auto until = clock_.time + duration; clock_.time < until; clock_.time += SecureLink::kSilence / 2) {
      from_server(server_.sealed(content(9), clock_.time));
      tick();
    }
  }

  std::uint64_t counted(security::Opening result) const { return secure_->counters().by_opening[result]; }

  test::FakeClock clock_;
  test::FakeLink link_;
  ServerEnd server_;
  ServerEnd restarted_;
  std::unique_ptr<Handshaker> handshaker_;
  std::unique_ptr<SecureLink> secure_;
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
  Bytes sent_;
  std::mt19937 random_{5};
};

TEST_F(SecureLinkTest, SendsNothingWithoutKeys) {
  begin();
  EXPECT_FALSE(secure_->ready());
  EXPECT_FALSE(secure_->send(content(1), kServer));
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(SecureLinkTest, AsksForACookieFirstByARequestAsLongAsAHelloThatSaysNothing) {
  begin();
  const Bytes first = next_sent();
  EXPECT_EQ(first.size(), security::kRequestBytes);
  const auto request = ServerEnd::request_in(first);
  EXPECT_EQ(request.cookie, security::Cookie{});
  EXPECT_THAT(request.message, testing::Each(std::byte{0}));
  EXPECT_NE(request.topic.client, 0U);
}

TEST_F(SecureLinkTest, SealsAndOpensAfterTheHandshake) {
  begin();
  shake_hands();
  EXPECT_EQ(secure_->counters().sessions, 1U);
  EXPECT_THAT(handshaker_->problem(), IsEmpty());
  EXPECT_EQ(handshaker_->take_news(), "encrypted (IKpsk2), server's key " + security::public_text(2));
  from_server(server_.sealed(content(5), clock_.time));
  from_server(server_.sealed(content(6), clock_.time));
  EXPECT_EQ(tick(), (std::vector<Bytes>{content(5), content(6)}));
  for (const auto& datagram : sent()) EXPECT_TRUE(security::is_record(datagram));
}

TEST_F(SecureLinkTest, TakesASharedKeyAlone) {
  Identity identity{.pattern = security::Pattern::nn_psk0, .server = "haptics:47800"};
  identity.shared = security::secret_key(3);
  server_.pattern = security::Pattern::nn_psk0;
  begin(std::move(identity));
  shake_hands();
  EXPECT_EQ(handshaker_->take_news(), "encrypted (NNpsk0), by the shared key");
}

TEST_F(SecureLinkTest, RepeatsARequestSoThatALateAnswerStillFits) {
  begin();
  const auto first = request();
  const Bytes message = bytes_of(first.message);
  const Bytes answer = server_.answer_to(first, clock_.time);
  for (int i = 0; i < 4; ++i) {
    const Bytes again = next_sent();
    EXPECT_EQ(bytes_of(ServerEnd::request_in(again).message), message);
  }
  from_server(answer);
  tick();
  tick();
  EXPECT_TRUE(secure_->ready());
}

TEST_F(SecureLinkTest, IsSentLessOftenTheLongerNobodyAnswers) {
  begin();
  int requests = 0;
  for (int ms = 0; ms < 25'000; ++ms) {
    tick();
    requests += static_cast<int>(sent().size());
  }
  EXPECT_GE(requests, 12);
  EXPECT_LE(requests, 17);
}

TEST_F(SecureLinkTest, MakesAnotherRequestAfterHalfAMinute) {
  begin();
  const std::uint32_t first = request().topic.client;
  for (int ms = 0; ms < 30'500; ++ms) tick();
  EXPECT_NE(ServerEnd::request_in(sent().back()).topic.client, first);
}

TEST_F(SecureLinkTest, ShowsItsKeyToTheServerThatIsExpectedAlone) {
  begin();
  server_.own = security::key_pair_from(security::key_bytes(9));
  EXPECT_THAT(server_.answer_to(request(), clock_.time), IsEmpty()) << "sealed for the expected one";
  EXPECT_THAT(handshaker_->problem(),
              AllOf(HasSubstr("haptics:47800 says that it has the key " + security::public_text(9)),
                    HasSubstr("not the one of --server-key")));
}

class KnownServersOfALink : public SecureLinkTest {
 protected:
  void begin_with(security::NewServers new_servers) {
    Identity identity{.server = "haptics:47800"};
    identity.own = security::key_pair_from(security::key_bytes(1));
    identity.shared = security::secret_key(3);
    identity.known = security::KnownServers::from_file(file_);
    identity.new_servers = new_servers;
    begin(std::move(identity));
  }

  test::TemporaryFolder folder_;
  std::string file_ = folder_.file("servers");
};

TEST_F(KnownServersOfALink, RefuseANewOneWithItsKey) {
  begin_with(security::NewServers::refused);
  from_server(server_.offer_for(ServerEnd::request_in(next_sent())));
  for (int ms = 0; ms < 3000; ++ms) tick();
  for (const auto& datagram : sent()) {
    EXPECT_THAT(ServerEnd::request_in(datagram).message, testing::Each(std::byte{0}));
  }
  EXPECT_THAT(handshaker_->problem(),
              AllOf(HasSubstr("is not named there"), HasSubstr(security::public_text(2)), HasSubstr("--trust-new")));
}

TEST_F(KnownServersOfALink, AddANewOneOnceItHasShownThatTheKeyIsItsOwn) {
  begin_with(security::NewServers::trusted);
  const auto asked = request();
  EXPECT_EQ(security::KnownServers::from_file(file_).find("haptics:47800"), std::nullopt);
  from_server(server_.answer_to(asked, clock_.time));
  tick();
  tick();
  EXPECT_TRUE(secure_->ready());
  EXPECT_EQ(security::KnownServers::from_file(file_).find("haptics:47800"), security::public_key(2));
}

TEST_F(KnownServersOfALink, KeepTheKeyOfAServerThatNowOffersAnother) {
  text::write_file(file_, "haptics:47800 " + security::public_text(2) + "\n");
  begin_with(security::NewServers::trusted);
  server_.own = security::key_pair_from(security::key_bytes(9));
  EXPECT_THAT(server_.answer_to(request(), clock_.time), IsEmpty());
  EXPECT_THAT(handshaker_->problem(), HasSubstr("but is known with the key " + security::public_text(2)));
}

TEST_F(SecureLinkTest, SaysThatTheServerDoesNotLetItIn) {
  server_.verdict = security::Verdict::not_allowed;
  begin();
  from_server(server_.answer_to(request(), clock_.time));
  tick();
  tick();
  EXPECT_FALSE(secure_->ready());
  EXPECT_THAT(handshaker_->problem(), HasSubstr("its list of clients lacks the key " + security::public_text(1)));
  server_.verdict = security::Verdict::let_in;
  server_.cookie[0] = std::byte{8};
  shake_hands();
  EXPECT_THAT(handshaker_->problem(), IsEmpty());
}

TEST_F(SecureLinkTest, SaysThatTheServerIsFull) {
  server_.verdict = security::Verdict::full;
  begin();
  from_server(server_.answer_to(request(), clock_.time));
  tick();
  tick();
  EXPECT_THAT(handshaker_->problem(), HasSubstr("haptics:47800 is full"));
}

TEST_F(SecureLinkTest, SaysThatTheSharedKeyIsAnother) {
  begin();
  server_.shared = security::secret_key(4);
  from_server(server_.answer_to(request(), clock_.time));
  tick();
  tick();
  EXPECT_FALSE(secure_->ready());
  EXPECT_THAT(handshaker_->problem(), HasSubstr("it has another --psk"));
}

TEST_F(SecureLinkTest, SaysThatTheServerTakesOtherKeys) {
  server_.pattern = security::Pattern::nn_psk0;
  begin();
  from_server(server_.offer_for(ServerEnd::request_in(next_sent())));
  for (int i = 0; i < 5; ++i) tick();
  EXPECT_THAT(handshaker_->problem(), HasSubstr("accepted is its shared key alone: --psk"));
}

TEST_F(SecureLinkTest, SaysThatNobodyAnswersTheHandshake) {
  begin();
  (void)request();
  for (int ms = 0; ms < 8000; ++ms) tick();
  EXPECT_THAT(handshaker_->problem(), HasSubstr("haptics:47800 does not answer the handshake: it has another key, or"));
}

TEST_F(SecureLinkTest, NamesTheNetworkFirstWhereTheServerKnewTheKeysBefore) {
  begin_and_lose_the_server();
  (void)request();
  for (int ms = 0; ms < 8000; ++ms) tick();
  EXPECT_THAT(handshaker_->problem(),
              HasSubstr("does not answer the handshake: datagrams are lost, or it has another key now"));
}

TEST_F(SecureLinkTest, DropsAndCountsWhatTheServerDidNotSeal) {
  begin();
  shake_hands();
  (void)tick();
  const Bytes good = server_.sealed(content(5), clock_.time);
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes flipped = good;
    flipped[bit / 8] ^= std::byte{1} << bit % 8;
    from_server(flipped);
  }
  from_server(content(6));
  link_.arrive(good, kOther);
  std::vector<Bytes> received;
  for (int i = 0; i < 20; ++i) {  // one tick drops only so many
    for (auto& each : tick()) received.push_back(std::move(each));
  }
  EXPECT_THAT(received, IsEmpty());
  EXPECT_GT(counted(security::Opening::not_authentic), 900U);
  EXPECT_GT(counted(security::Opening::other_session), 0U);
  EXPECT_GT(counted(security::Opening::unknown_key), 0U);
  EXPECT_GE(secure_->counters().in_clear, 24U + 1) << "of the mark and version, each bit";
  from_server(good);
  EXPECT_EQ(tick(), std::vector<Bytes>{content(5)}) << "none of them used up its counter";
  from_server(good);
  EXPECT_THAT(tick(), IsEmpty());
  EXPECT_EQ(counted(security::Opening::replayed), 1U);
}

TEST_F(SecureLinkTest, TakesNoAnswerThatSomebodyForges) {
  begin();
  const auto asked = request();
  const Bytes answer = server_.answer_to(asked, clock_.time);
  for (std::size_t byte = 0; byte < answer.size(); ++byte) {
    Bytes forged = answer;
    forged[byte] ^= std::byte{0x10};
    from_server(forged);
    tick();
    tick();
    ASSERT_FALSE(secure_->ready()) << "byte " << byte;
  }
  from_server(answer);
  tick();
  tick();
  EXPECT_TRUE(secure_->ready());
}

TEST_F(SecureLinkTest, IsMadeToSendNoMoreThan50RequestsASecondByForgedOffers) {
  begin();
  const auto asked = request();
  (void)sent();
  for (int ms = 0; ms < 10'000; ++ms) {
    server_.cookie[0] = static_cast<std::byte>(ms);
    server_.cookie[1] = static_cast<std::byte>(ms >> 8);
    from_server(server_.offer_for(asked));
    tick();
  }
  EXPECT_LE(sent().size(), 501U);
}

/// Somebody beside the path sees each request, and has his cookies at the client 20 ms before the server's answer:
///
///     client ------- request -------> server, which answers wrong cookies with the right one
///        ^ \------ seen -----> man
///        |  `<--- forged, 20 ms ---'
///        `<------------ answer or true cookie, 40 ms ---- server
class ForgedCookies : public SecureLinkTest {
 protected:
  /// For how long the client is kept out. @param forged cookies for each request @param as the server's, or the man's
  time::Nanoseconds kept_out(int forged, bool as_another_server = false) {
    std::multimap<time::Nanoseconds, Bytes> on_the_way;
    std::mt19937 of_the_man{7};
    const time::Nanoseconds begun = clock_.time;
    while (!secure_->ready() && clock_.time - begun < 60s) {
      for (; !on_the_way.empty() && on_the_way.begin()->first <= clock_.time; on_the_way.erase(on_the_way.begin())) {
        from_server(on_the_way.begin()->second);
      }
      tick();
      for (const Bytes& datagram : sent()) {
        const auto asked = ServerEnd::request_in(datagram);
        ServerEnd man;
        man.pattern = server_.pattern;
        if (!as_another_server) man.own = security::key_pair_from(*server_.own.secret);
        for (int i = 0; i < forged; ++i) {
          std::ranges::generate(man.cookie, [&] { return static_cast<std::byte>(of_the_man()); });
          if (as_another_server)
            man.own = security::key_pair_from(security::key_bytes(static_cast<std::uint8_t>(of_the_man())));
          on_the_way.emplace(clock_.time + 20ms, man.offer_for(asked));
        }
        const bool good = asked.cookie == server_.cookie;
        Bytes answer = good ? server_.answer_to(asked, clock_.time) : server_.offer_for(asked);
        if (!answer.empty()) on_the_way.emplace(clock_.time + 40ms, std::move(answer));
      }
    }
    return clock_.time - begun;
  }
};

TEST_F(ForgedCookies, BeforeTheTrueOnesDoNotKeepAClientOut) {
  begin();
  EXPECT_LT(kept_out(1), 1s);
}

TEST_F(ForgedCookies, DoNotKeepAClientOutThatHasASharedKeyAlone) {
  Identity identity{.pattern = security::Pattern::nn_psk0, .server = "haptics:47800"};
  identity.shared = security::secret_key(3);
  server_.pattern = security::Pattern::nn_psk0;
  begin(std::move(identity));
  EXPECT_LT(kept_out(1), 1s);
}

TEST_F(ForgedCookies, InAnyNumberMakeItWaitForItsTurn) {
  begin();
  EXPECT_LT(kept_out(10), 3s);
  begin();
  EXPECT_LT(kept_out(100), 30s) << "5,000 forged ones a second";
}

TEST_F(ForgedCookies, WithOtherKeysDoNotKeepAClientOutThatTrustsANewServer) {
  const test::TemporaryFolder folder;
  Identity identity{.server = "haptics:47800", .own = security::key_pair_from(security::key_bytes(1))};
  identity.shared = security::secret_key(3);
  identity.known = security::KnownServers::from_file(folder.file("servers"));
  identity.new_servers = security::NewServers::trusted;
  begin(std::move(identity));
  EXPECT_LT(kept_out(1, true), 30s);
  EXPECT_EQ(security::KnownServers::from_file(folder.file("servers")).find("haptics:47800"), security::public_key(2));
}

TEST_F(SecureLinkTest, ChangesItsKeyAfterTwoMinutesWithoutAGap) {
  begin();
  shake_hands();
  pass(121s);
  tick();
  const Bytes record = next_sent();
  EXPECT_TRUE(security::is_record(record)) << "a later handshake is sealed";
  const Bytes asked = server_.opened(record, clock_.time);
  ASSERT_TRUE(security::is_handshake(asked));
  EXPECT_LE(asked.size(), security::kSealedRequestBytesMost);
  const auto later = ServerEnd::request_in(asked);
  EXPECT_EQ(later.topic.handshake, 2);
  const Bytes under_old = server_.sealed(content(4), clock_.time);
  const Bytes answer = server_.answer_to(later, clock_.time);
  from_server(server_.sealed(answer, clock_.time));
  tick();
  tick();
  EXPECT_EQ(secure_->counters().rekeys, 1U);
  (void)sent();
  EXPECT_TRUE(secure_->send(content(3), kServer));
  EXPECT_EQ(server_.opened(sent().back(), clock_.time), content(3));
  EXPECT_EQ(server_.channel->handshake(), 2);
  from_server(under_old);
  from_server(server_.sealed(content(5), clock_.time));
  EXPECT_EQ(tick(), (std::vector<Bytes>{content(4), content(5)}));
}

TEST_F(SecureLinkTest, AsksAgainForAKeyWhoseHandshakeWasLost) {
  begin();
  shake_hands();
  pass(120s);
  tick();
  const Bytes first = server_.opened(next_sent(), clock_.time);
  const Bytes again = server_.opened(next_sent(), clock_.time);
  EXPECT_EQ(first, again);
}

TEST_F(SecureLinkTest, BeginsAnotherSessionWhenTheServerIsSilentAndUsesTheOldOneMeanwhile) {
  begin_and_lose_the_server();
  const auto asked = request();
  EXPECT_TRUE(secure_->ready());
  EXPECT_TRUE(secure_->send(content(2), kServer));
  EXPECT_EQ(server_.opened(sent().back(), clock_.time), content(2));
  answer_as_restarted(asked);
  const Bytes on_its_way = server_.sealed(content(7), clock_.time);
  tick();
  tick();
  EXPECT_EQ(secure_->counters().sessions, 2U);
  (void)sent();
  EXPECT_TRUE(secure_->send(content(3), kServer));
  EXPECT_EQ(restarted_.opened(sent().back(), clock_.time), content(3));
  from_server(on_its_way);
  from_server(restarted_.sealed(content(8), clock_.time));
  EXPECT_EQ(tick(), (std::vector<Bytes>{content(7), content(8)}));
}

TEST_F(SecureLinkTest, WaitsLongerForTheFirstThatAServerSaysFromAfar) {
  begin();
  shake_hands();
  send_unanswered();
  clock_.time += SecureLink::kFirstSilence - 10ms;
  for (int ms = 0; ms < 9; ++ms) tick();
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(request().topic.handshake, 1);
}

TEST_F(SecureLinkTest, KeepsItsKeysWhileNothingOrLittleWasSent) {
  begin();
  shake_hands();
  receive();
  for (int ms = 0; ms < 10'000; ++ms) tick();
  for (int i = 1; i < SecureLink::kUnansweredLeast; ++i) EXPECT_TRUE(secure_->send(content(2), kServer));
  (void)sent();
  for (int ms = 0; ms < 10'000; ++ms) tick();
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_TRUE(secure_->send(content(2), kServer));
  (void)sent();
  EXPECT_EQ(request().topic.handshake, 1) << "the first of them was sent long ago";
}

TEST_F(SecureLinkTest, TakesNothingUnderOldKeysForAnAnswerUnderNewOnes) {
  begin_and_lose_the_server();
  const auto asked = request();
  answer_as_restarted(asked);
  const Bytes on_its_way = server_.sealed(content(7), clock_.time);
  tick();
  tick();
  send_unanswered();
  from_server(on_its_way);
  EXPECT_EQ(tick(), std::vector<Bytes>{content(7)});
  clock_.time += 2 * SecureLink::kSilence;
  for (int ms = 0; ms < 10; ++ms) tick();
  EXPECT_THAT(sent(), IsEmpty()) << "a first answer may come from afar";
  clock_.time += SecureLink::kFirstSilence;
  EXPECT_EQ(request().topic.handshake, 1);
}

TEST_F(SecureLinkTest, StopsAskingWhenTheServerSpeaksAgain) {
  begin_and_lose_the_server();
  (void)next_sent();
  from_server(server_.sealed(content(7), clock_.time));
  EXPECT_EQ(tick(), std::vector<Bytes>{content(7)});
  tick();
  (void)sent();
  for (int ms = 0; ms < 400; ++ms) tick();
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(secure_->counters().sessions, 1U);
}

TEST_F(SecureLinkTest, SealsNothingUnderAnExpiredKey) {
  begin();
  shake_hands();
  clock_.time += security::kKeyExpiresAfter;
  EXPECT_FALSE(secure_->ready());
  EXPECT_FALSE(secure_->send(content(1), kServer));
  const auto asked = ServerEnd::request_in(next_sent());
  EXPECT_EQ(asked.topic.handshake, 1);
}

TEST_F(SecureLinkTest, DoesNotAllocateInTheTick) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  begin();
  shake_hands();
  link_.reserve(4);
  link_.keep = false;
  const Bytes record = server_.sealed(content(5), clock_.time);
  const Bytes plain = content(4);
  link_.arrive_again(record, kServer);
  link_.arrive_again(record, kServer);
  link_.arrive_again(plain, kServer);
  const test::AllocationGuard guard;
  EXPECT_TRUE(secure_->receive(buffer_).has_value());
  EXPECT_FALSE(secure_->receive(buffer_).has_value());
  EXPECT_TRUE(secure_->send(plain, kServer));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
