#include "tests/unit/server/security/secure_link_fixture.hpp"

namespace forcebound::server {
namespace {

/// The links of two workers with the same list:
///
///     ClientEnd --arrive--> link (worker 0) --move--> other (worker 1)
class SecureLinkMoves : public SecureLinkFixture {
 protected:
  using MovedOut = SecureLink::MovedOut;

  void start_both(std::size_t most = 20, std::size_t sessions_max = 64) {
    sessions_max_ = sessions_max;
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
    return {.sessions_max = sessions_max_, .idle_timeout = 60s, .worker = worker, .workers = 2, .moved = &*moved};
  }

  static std::uint32_t keys_of(const Bytes& record) { return security::session_of_record(record); }

  /// What it says last comes from there.
  SecureLink::MovedOut try_to_move(ClientEnd& client, const net::Address& from = at_port(1)) {
    const auto content = link->accept(client.seal("hello", clock.time), from, clock.time);
    std::optional<SecureLink::Moving> moving;
    const auto moved_out = link->move_out(content->keys, 1, clock.time, [&](SecureLink::Moving& keys) {
      moving.emplace(std::move(keys));
      return true;
    });
    there_ = moved_out == MovedOut::moved && other->move_in(std::move(*moving), from, clock.time).has_value();
    return moved_out;
  }

  /// Whether it moved and is there.
  bool move(ClientEnd& client, const net::Address& from = at_port(1)) {
    return try_to_move(client, from) == MovedOut::moved && there_;
  }

  /// Lets the clock go on, as no source may make so many at once.
  ClientEnd made_at_link(const security::KeyPair& own) {
    clock.time += 200ms;
    ClientEnd client({.own = &own, .server = &server}, ++number_);
    join(client, place());
    return client;
  }

  /// Whether the other gave it keys.
  bool made_at_other(const security::KeyPair& own) {
    clock.time += 200ms;
    ClientEnd client({.own = &own, .server = &server}, ++number_);
    (void)other->accept(client.request(), place(), clock.time);
    if (!client.accept_offer(other_inner.sent.back().bytes)) return false;
    (void)other->accept(client.request(), place(), clock.time);
    other->answer_waiting(clock.time);
    const auto admission = client.accept_answer(other_inner.sent.back().bytes, clock.time);
    return admission && admission->verdict == security::Verdict::let_in &&
           other->accept(client.seal("hello", clock.time), place(), clock.time).has_value();
  }

  /// Of the client made last.
  [[nodiscard]] net::Address place() const { return at_port(static_cast<std::uint16_t>(number_)); }

  std::string received_from_other(ClientEnd& client, const net::Address& to) {
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
  std::size_t sessions_max_ = 64;
  std::uint32_t number_ = 0;
  bool there_ = false;
};

TEST_F(SecureLinkMoves, MoveToAWorkerThatThenOpensAndSealsForThem) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  ASSERT_TRUE(move(client));
  const Bytes record = client.seal("more", clock.time);
  EXPECT_EQ(link->moved_to(record), 1U);
  EXPECT_EQ(other->moved_to(record), std::nullopt) << "it is there";
  EXPECT_FALSE(link->accept(record, at_port(1), clock.time));
  EXPECT_TRUE(other->accept(record, at_port(1), clock.time));
  EXPECT_EQ(received_from_other(client, at_port(1)), "force");
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(1)));
}

TEST_F(SecureLinkMoves, StayAsTheyAreWhereTheOtherDoesNotTakeThem) {
  start_both();
  ClientEnd client = anna_end();
  join(client);
  const Bytes record = client.seal("more", clock.time);
  EXPECT_EQ(link->move_out(keys_of(record), 1, clock.time, [](SecureLink::Moving&) { return false; }),
            MovedOut::not_taken);
  EXPECT_EQ(link->moved_to(record), std::nullopt);
  EXPECT_EQ(moved->count(), 0U);
  EXPECT_EQ(link->confirmed(), 1U);
  EXPECT_EQ(received_by(client, "force", at_port(1)), "force");
  EXPECT_TRUE(arrive(record).has_value());
}

TEST_F(SecureLinkMoves, StayWhereAsManyHaveMovedAsMay) {
  start_both(1);
  ClientEnd first = anna_end(11);
  ClientEnd second = anna_end(12);
  join(first, at_port(1));
  join(second, at_port(2));
  EXPECT_TRUE(move(first, at_port(1)));
  EXPECT_EQ(try_to_move(second, at_port(2)), MovedOut::too_many);
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
  EXPECT_EQ(received_from_other(victim, at_port(1)), "force");
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
      EXPECT_FALSE(other->accept(forged, at_port(1), clock.time));
    }
    link->on_timer(clock.time);
    other->on_timer(clock.time);
  }
  EXPECT_EQ(other->confirmed(), 0U);
  EXPECT_EQ(link->moved_to(forged), std::nullopt);
  EXPECT_EQ(moved->count(), 0U);
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
  const auto give = [&](SecureLink::Moving& keys) {
    moving.emplace(std::move(keys));
    return true;
  };
  ASSERT_EQ(other->move_out(keys_of(record), 0, clock.time, give), MovedOut::moved);
  EXPECT_EQ(moved->count(), 1U) << "on the way its place is kept";
  ASSERT_TRUE(link->move_in(std::move(*moving), at_port(1), clock.time));
  EXPECT_EQ(moved->count(), 0U);
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
  const auto refuse = [&](SecureLink::Moving&) { return ++asked == 0; };
  for (int i = 0; i < 5; ++i) EXPECT_EQ(link->move_out(keys, 1, clock.time, refuse), MovedOut::not_taken);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(link->move_out(keys, 1, clock.time, refuse), MovedOut::too_often);
  EXPECT_EQ(asked, 5);
}

TEST_F(SecureLinkMoves, GiveAWorkerNoMoreKeysOfItsOwnThanItHasRoomForWhoeverIsSilent) {
  start_both(20, 1);
  const std::size_t most = limits_of(1).confirmed_most();
  for (int i = 0; i < 10; ++i) {
    ClientEnd client = made_at_link(anna);
    ASSERT_TRUE(move(client, place()));
  }
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(made_at_other(anna));
  for (std::size_t i = 2; i < most; ++i) EXPECT_TRUE(made_at_other(bert));
  ASSERT_EQ(other->confirmed(), most + 10);
  for (int i = 0; i < 10; ++i) {
    (void)made_at_other(bert);
    EXPECT_LE(other->confirmed() - moved->count(), most) << "anna's that are from elsewhere have no place among these";
  }
  EXPECT_EQ(moved->count(), 10U);
}

TEST_F(SecureLinkMoves, LeaveRoomForOthersHowManyEverOneClientMoves) {
  start_both(10, 1);
  std::size_t moves = 0;
  for (int i = 0; i < 15; ++i) {
    ClientEnd client = made_at_link(anna);
    moves += move(client, place()) ? 1 : 0;
  }
  EXPECT_EQ(moves, 5U) << "as many as it left free";
  EXPECT_EQ(link->confirmed(), limits_of(0).confirmed_most());
  ClientEnd newcomer = made_at_link(bert);
  EXPECT_TRUE(move(newcomer, place()));
}

TEST_F(SecureLinkMoves, ComeBackThoughOthersHaveTakenTheirPlaces) {
  start_both(20, 1);
  const std::size_t most = limits_of(0).confirmed_most();
  std::vector<std::uint32_t> away;
  for (int i = 0; i < 10; ++i) {
    ClientEnd client = made_at_link(anna);
    away.push_back(keys_of(client.seal("more", clock.time)));
    ASSERT_TRUE(move(client, place()));
  }
  for (std::size_t i = 0; i < most; ++i) (void)made_at_link(bert);
  ASSERT_EQ(link->confirmed(), most);
  for (const std::uint32_t keys : away) {
    const auto move_in = [&](SecureLink::Moving& moving) {
      return link->move_in(std::move(moving), at_port(static_cast<std::uint16_t>(keys)), clock.time).has_value();
    };
    EXPECT_EQ(other->move_out(keys, 0, clock.time, move_in), MovedOut::moved);
  }
  EXPECT_EQ(link->confirmed(), most + 10);
  EXPECT_EQ(moved->count(), 0U);
}

TEST(MovedKeys, KnowThemUntilTheyAreBackOrForgotten) {
  MovedKeys moved(2, 4);
  EXPECT_EQ(moved.worker_of(0x101), std::nullopt);
  EXPECT_TRUE(moved.store(0x101, 3));
  EXPECT_TRUE(moved.store(0x102, 3));
  EXPECT_FALSE(moved.store(0x103, 0)) << "two are as many as may be";
  EXPECT_TRUE(moved.store(0x101, 2)) << "but those that moved may move on";
  EXPECT_EQ(moved.worker_of(0x101), 2U);
  EXPECT_EQ(moved.count(), 2U);
  EXPECT_TRUE(moved.store(0x101, 1));
  EXPECT_EQ(moved.worker_of(0x101), std::nullopt);
  moved.forget(0x102);
  EXPECT_EQ(moved.worker_of(0x102), std::nullopt);
  EXPECT_TRUE(moved.store(0x103, 0));
}

TEST(MovedKeys, AreOfAClientNoMoreThanItLeavesFree) {
  const security::PublicKey one = security::public_key(1);
  const security::PublicKey two = security::public_key(2);
  MovedKeys moved(4, 2);
  EXPECT_TRUE(moved.store(2, 1, &one));
  EXPECT_TRUE(moved.store(4, 1, &one));
  EXPECT_FALSE(moved.store(6, 1, &one));
  EXPECT_TRUE(moved.store(8, 1, &two));
  EXPECT_FALSE(moved.store(10, 1, &two)) << "one is left, for a third";
  EXPECT_TRUE(moved.store(10, 1)) << "whose client is not known";
}

}  // namespace
}  // namespace forcebound::server
