#include "tests/unit/server/security/secure_link_fixture.hpp"

namespace forcebound::server {
namespace {

/// The links of two workers with the same list:
///
///     ClientEnd --arrive--> link (worker 0) --move--> other (worker 1)
class SecureLinkMoves : public SecureLinkFixture {
 protected:
  void start_both(std::size_t most = 20) {
    moved.emplace(most, 2);
    start_with_two(limits_of(0));
    ServerKeys keys{.own = security::key_pair_from(security::key_bytes(2))};
    keys.clients = list("anna", 1, "bert", 4);
    other.emplace(std::move(keys), limits_of(1), other_inner, clock, [this](std::span<std::byte> bytes) {
      std::ranges::generate(bytes, [this] { return static_cast<std::byte>(random_() & 0xffU); });
    });
  }

  static security::AllowedClients list(const std::string& one, std::uint8_t key, const std::string& two,
                                       std::uint8_t other_key) {
    const auto entry = [](const std::string& name, std::uint8_t of) {
      return "[[client]]\nname = \"" + name + "\"\npublic_key = \"" + security::public_text(of) + "\"\n";
    };
    return security::AllowedClients::parse(entry(one, key) + entry(two, other_key), "clients.toml");
  }

  [[nodiscard]] SecureLimits limits_of(std::size_t worker) {
    return {.idle_timeout = 60s, .worker = worker, .workers = 2, .moved = &*moved};
  }

  static std::uint32_t keys_of(const Bytes& record) { return security::session_of_record(record); }

  /// Whether it moved; what it says last comes from there.
  bool move(ClientEnd& client, const net::Address& from = at_port(1)) {
    const auto content = link->take_in(client.seal("hello", clock.time), from, clock.time);
    std::optional<SecureLink::Moving> moving;
    const bool given = link->move_out(content->keys, 1, clock.time, [&](SecureLink::Moving& keys) {
      moving.emplace(std::move(keys));
      return true;
    });
    return given && other->move_in(std::move(*moving), from, clock.time).has_value();
  }

  std::string heard_from_other(ClientEnd& client, const net::Address& to) {
    other_inner.sent.clear();
    if (!other->send(bytes_of("force"), to)) return "";
    const auto opened = client.open(other_inner.sent.at(0).bytes, clock.time);
    return opened ? std::string(reinterpret_cast<const char*>(opened->data()), opened->size()) : "";
  }

  std::optional<MovedKeys> moved;
  test::FakeLink other_inner;
  std::optional<SecureLink> other;

 private:
  std::mt19937_64 random_{7};
};

TEST_F(SecureLinkMoves, MoveToAWorkerThatThenOpensAndSealsForThem) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  ASSERT_TRUE(move(client));
  const Bytes record = client.seal("more", clock.time);
  EXPECT_EQ(link->moved_to(record), 1U);
  EXPECT_EQ(other->moved_to(record), std::nullopt) << "it is there";
  EXPECT_FALSE(link->take_in(record, at_port(1), clock.time));
  EXPECT_TRUE(other->take_in(record, at_port(1), clock.time));
  EXPECT_EQ(heard_from_other(client, at_port(1)), "force");
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(1)));
}

TEST_F(SecureLinkMoves, StayAsTheyAreWhereTheOtherDoesNotTakeThem) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  const Bytes record = client.seal("more", clock.time);
  EXPECT_FALSE(link->move_out(keys_of(record), 1, clock.time, [](SecureLink::Moving&) { return false; }));
  EXPECT_EQ(link->moved_to(record), std::nullopt);
  EXPECT_EQ(moved->away_from(0), 0U);
  EXPECT_EQ(link->confirmed(), 1U);
  EXPECT_EQ(heard_by(client, "force", at_port(1)), "force");
  EXPECT_TRUE(arrive(record).has_value());
}

TEST_F(SecureLinkMoves, StayWhereAsManyHaveMovedAsMay) {
  start_both(1);
  ClientEnd first = anna_end(11);
  ClientEnd second = anna_end(12);
  join(first, at_port(1));
  join(second, at_port(2));
  EXPECT_TRUE(move(first, at_port(1)));
  EXPECT_FALSE(move(second, at_port(2)));
  EXPECT_TRUE(arrive(second.seal("still here", clock.time), at_port(2)).has_value());
}

TEST_F(SecureLinkMoves, DoNotTakeTheAddressOfAnotherClientThatWasJustHeardThere) {
  start_both();
  ClientEnd victim(ClientEnd::Keys{.own = &bert, .server = &server}, 12);
  join(victim);
  ASSERT_TRUE(move(victim));
  ClientEnd client = anna_end();
  join(client);
  ASSERT_TRUE(move(client)) << "which sends from the other's address";
  EXPECT_EQ(other->counters().addresses_of_others, 1U);
  EXPECT_EQ(heard_from_other(victim, at_port(1)), "force");
}

TEST_F(SecureLinkMoves, AreForgottenEverywhereAtOnceWhateverIsSentUnderTheirNumber) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  ASSERT_TRUE(move(client));
  Bytes forged = client.seal("more", clock.time);
  forged.back() ^= std::byte{1};
  for (int i = 0; i < 100; ++i) {
    clock.time += 1s;
    if (link->moved_to(forged)) {
      EXPECT_FALSE(other->take_in(forged, at_port(1), clock.time));
    }
    link->on_timer(clock.time);
    other->on_timer(clock.time);
  }
  EXPECT_EQ(other->confirmed(), 0U);
  EXPECT_EQ(link->moved_to(forged), std::nullopt);
  EXPECT_EQ(moved->away_from(0), 0U);
}

TEST_F(SecureLinkMoves, AreNoMoreWhereTheOtherHasDroppedTheClient) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  other->replace_clients(list("carl", 5, "bert", 4));
  EXPECT_FALSE(move(client));
  EXPECT_EQ(link->moved_to(client.seal("more", clock.time)), std::nullopt);
  EXPECT_EQ(other->confirmed(), 0U);
}

TEST_F(SecureLinkMoves, MoveBackAndAreNoLongerMoved) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  ASSERT_TRUE(move(client));
  std::optional<SecureLink::Moving> moving;
  const Bytes record = client.seal("more", clock.time);
  ASSERT_TRUE(other->move_out(keys_of(record), 0, clock.time, [&](SecureLink::Moving& keys) {
    moving.emplace(std::move(keys));
    return true;
  }));
  EXPECT_EQ(moved->away_from(0), 1U) << "on the way its place is kept";
  ASSERT_TRUE(link->move_in(std::move(*moving), at_port(1), clock.time));
  EXPECT_EQ(moved->away_from(0), 0U);
  EXPECT_EQ(other->confirmed(), 0U);
  EXPECT_EQ(link->confirmed(), 1U);
  EXPECT_TRUE(arrive(record).has_value());
}

TEST_F(SecureLinkMoves, MoveFewTimesASecond) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  const auto keys = keys_of(client.seal("more", clock.time));
  int asked = 0;
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(link->move_out(keys, 1, clock.time, [&](SecureLink::Moving&) { return ++asked == 0; }));
  }
  EXPECT_EQ(asked, 5);
}

TEST(MovedKeys, KnowThemUntilTheyAreBackOrForgotten) {
  MovedKeys moved(2, 4);
  EXPECT_EQ(moved.worker_of(0x101), std::nullopt);
  EXPECT_TRUE(moved.note(0x101, 3));
  EXPECT_TRUE(moved.note(0x102, 3));
  EXPECT_FALSE(moved.note(0x103, 0)) << "two are as many as may be";
  EXPECT_TRUE(moved.note(0x101, 2)) << "but those that moved may move on";
  EXPECT_EQ(moved.worker_of(0x101), 2U);
  EXPECT_EQ(moved.away_from(1), 1U);
  EXPECT_TRUE(moved.note(0x101, 1));
  EXPECT_EQ(moved.worker_of(0x101), std::nullopt);
  moved.forget(0x102);
  EXPECT_EQ(moved.worker_of(0x102), std::nullopt);
  EXPECT_TRUE(moved.note(0x103, 0));
}

}  // namespace
}  // namespace forcebound::server
