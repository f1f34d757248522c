#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/security/secure_link_fixture.hpp"

namespace forcebound::server {
namespace {

using security::Opening;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

/// A link with one client.
class SealedDatagrams : public SecureLinkFixture {
 protected:
  void SetUp() override {
    start_with_list();
    join(client);
  }

  ClientEnd client = anna_end();
};

TEST_F(SealedDatagrams, WithAnyBitFlippedAreDroppedAndLeaveTheTrueOneGood) {
  const Bytes record = client.seal("a motion", clock.time);
  for (std::size_t bit = 0; bit < 8 * record.size(); ++bit) {
    Bytes flipped = record;
    flipped[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(arrive(flipped)) << bit;
  }
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_GT(records(Opening::not_authentic), 8 * 16U);
  EXPECT_THAT(*arrive(record), Pair("a motion", "anna"));
}

TEST_F(SealedDatagrams, AreOpenedOnce) {
  const Bytes record = client.seal("motion", clock.time);
  EXPECT_TRUE(arrive(record).has_value());
  EXPECT_FALSE(arrive(record));
  EXPECT_FALSE(arrive(record, at_port(9))) << "from elsewhere neither";
  EXPECT_EQ(records(Opening::replayed), 2U);
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(9))) << "a replayed one takes no answers with it";
}

TEST_F(SealedDatagrams, AreOpenedInAnyOrder) {
  std::vector<Bytes> all;
  all.reserve(1000);
  for (int i = 0; i < 1000; ++i) all.push_back(client.seal(std::to_string(i), clock.time));
  for (int i = 999; i >= 0; --i) {
    EXPECT_THAT(*arrive(all[static_cast<std::size_t>(i)]), Pair(std::to_string(i), "anna"));
  }
}

TEST_F(SealedDatagrams, OfAnotherSessionAreDropped) {
  ClientEnd other = anna_end(12);
  join(other, at_port(2));
  Bytes record = client.seal("motion", clock.time);
  const Bytes of_other = other.seal("motion", clock.time);
  // The number of the session, of the other one.
  std::copy_n(of_other.begin() + 4, 4, record.begin() + 4);
  EXPECT_FALSE(arrive(record));
  EXPECT_EQ(records(Opening::not_authentic), 1U);
  record[4] ^= std::byte{0x55};
  EXPECT_FALSE(arrive(record));
  EXPECT_EQ(records(Opening::other_session), 1U);
}

TEST_F(SealedDatagrams, AreAnsweredWhereTheNewestTwoCameFrom) {
  for (const std::uint16_t port : {std::uint16_t{2}, std::uint16_t{3}}) {
    EXPECT_TRUE(arrive(client.seal("motion", clock.time), at_port(port)).has_value());
  }
  EXPECT_EQ(received_by(client, "force", at_port(3)), "force");
  EXPECT_EQ(received_by(client, "force", at_port(2)), "force");
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(1)));
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(4))) << "from there nothing came";
}

TEST_F(SealedDatagrams, DecideByTheNewestWhoseKeysAnAddressGets) {
  ClientEnd next = anna_end(12);
  join(next);
  EXPECT_EQ(received_by(next, "force", at_port(1)), "force");
  EXPECT_TRUE(arrive(client.seal("motion", clock.time)).has_value());
  EXPECT_EQ(received_by(client, "force", at_port(1)), "force");
}

TEST_F(SealedDatagrams, FromTheAddressOfAnotherClientDoNotGetWhatIsMeantForIt) {
  start_with_two();
  ClientEnd honest = anna_end();
  ClientEnd forges({.own = &bert, .server = &server}, 12);
  join(honest, at_port(1));
  join(forges, at_port(2));
  EXPECT_TRUE(arrive(forges.seal("motion", clock.time), at_port(1)).has_value());
  EXPECT_EQ(received_by(honest, "force", at_port(1)), "force");
  EXPECT_EQ(link->counters().addresses_of_others, 1U);
  // An address that is used no more may become another's.
  clock.time += 2s;
  EXPECT_TRUE(arrive(forges.seal("motion", clock.time), at_port(1)).has_value());
  EXPECT_EQ(received_by(forges, "force", at_port(1)), "force");
}

TEST_F(SealedDatagrams, AreOpenedOfClientsOnANewListAndOfNoOthers) {
  start_with_two();
  ClientEnd stays = anna_end();
  ClientEnd goes({.own = &bert, .server = &server}, 12);
  join(stays, at_port(1));
  join(goes, at_port(2));
  link->replace_clients(security::AllowedClients::parse(
      "[[client]]\nname = \"anne\"\npublic_key = \"" + security::public_text(1) + "\"\n", "clients.toml"));
  EXPECT_THAT(*arrive(stays.seal("motion", clock.time), at_port(1)), Pair("motion", "anne"));
  EXPECT_FALSE(arrive(goes.seal("motion", clock.time), at_port(2)));
  EXPECT_EQ(link->confirmed(), 1U);
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(2)));
  ClientEnd again({.own = &bert, .server = &server}, 13);
  EXPECT_EQ(shake_hands(again, at_port(2))->verdict, security::Verdict::not_allowed);
}

TEST_F(SealedDatagrams, KeepTheSessionForTheIdleTimeoutAndAWhileMore) {
  const SecureLimits limits;
  clock.time += limits.idle_timeout + SecureLink::kKeptAfterIdle - 1ns;
  link->on_timer(clock.time);
  EXPECT_EQ(link->confirmed(), 1U);
  EXPECT_TRUE(arrive(client.seal("motion", clock.time)).has_value());
  clock.time += limits.idle_timeout + SecureLink::kKeptAfterIdle;
  link->on_timer(clock.time);
  EXPECT_EQ(link->confirmed(), 0U);
  EXPECT_FALSE(link->send(bytes_of("force"), at_port(1)));
  EXPECT_FALSE(arrive(client.seal("motion", clock.time)));
  EXPECT_EQ(link->counters().sessions_idle, 1U);
}

TEST_F(SealedDatagrams, FreeTheAddressesOfSessionsThatAreNoMore) {
  for (std::uint32_t round = 0; round < 300; ++round) {
    clock.time += 90s;
    link->on_timer(clock.time);
    ClientEnd next = anna_end(100 + round);
    join(next, at_port(static_cast<std::uint16_t>(10 + round)));
    EXPECT_TRUE(arrive(next.seal("motion", clock.time), at_port(static_cast<std::uint16_t>(11 + round))).has_value());
    EXPECT_EQ(link->confirmed(), 1U);
    EXPECT_EQ(received_by(next, "force", at_port(static_cast<std::uint16_t>(10 + round))), "force");
  }
}

TEST_F(SealedDatagrams, OfTheGreatestLengthPass) {
  const std::string longest(wire::kFrameBytesMax, 'x');
  EXPECT_THAT(*arrive(client.seal(longest, clock.time)), Pair(longest, "anna"));
  EXPECT_EQ(received_by(client, longest, at_port(1)), longest);
  EXPECT_FALSE(link->send(Bytes(net::kDatagramBytesMax), at_port(1)));
}

TEST_F(SealedDatagrams, AreTakenFromTheOtherLinkToo) {
  inner.arrive(bytes_of("noise"), at_port(7));
  inner.arrive(client.seal("motion", clock.time), at_port(1));
  Bytes buffer(net::kDatagramBytesMax);
  const auto received = link->receive(buffer);
  ASSERT_TRUE(received.has_value());
  EXPECT_EQ(received->bytes, 6U);
  EXPECT_EQ(received->from, at_port(1));
  EXPECT_EQ(Bytes(buffer.begin(), buffer.begin() + 6), bytes_of("motion"));
  EXPECT_FALSE(link->receive(buffer));
}

TEST_F(SealedDatagrams, DoNotAllocateNorDoThoseThatAreDroppedNorNewAddresses) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  constexpr std::uint16_t kRecords = 100;
  std::vector<Bytes> all;
  all.reserve(kRecords);
  for (int i = 0; i < kRecords; ++i) all.push_back(client.seal("motion", clock.time));
  const Bytes force(wire::kFrameBytesMax);
  const Bytes noise(wire::kFrameBytesMax);
  inner.keep = false;
  std::uint64_t opened = 0;
  std::uint64_t answered = 0;
  const test::AllocationGuard guard;
  for (std::uint16_t i = 0; i < kRecords; ++i) {
    const net::Address from = at_port(static_cast<std::uint16_t>(20 + i % 5));
    Bytes& record = all[i];
    opened += link->accept(record, from, clock.time) ? 1 : 0;
    answered += link->send(force, from) ? 1 : 0;
    (void)link->accept(record, from, clock.time);  // replayed
    record.back() ^= std::byte{1};
    (void)link->accept(record, from, clock.time);  // not authentic, or replayed
    (void)link->accept(noise, from, clock.time);
    link->on_timer(clock.time);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(opened, kRecords);
  EXPECT_EQ(answered, kRecords);
}

class InTheClear : public SecureLinkFixture {
 protected:
  void SetUp() override { start_with_list(); }
  wire::Codec codec;
};

TEST_F(InTheClear, AHelloIsRefusedWithWhatWouldBeAccepted) {
  const auto hello = codec.encode(wire::Hello{.client_nonce = 42, .degrees_of_freedom = 1, .period_s = 1e-3});
  EXPECT_FALSE(arrive(hello));
  const Bytes answer = only_answer();
  const auto decoded = codec.decode(answer);
  const auto& refusal = std::get<wire::Refusal>(std::get<wire::Message>(decoded));
  EXPECT_EQ(refusal.reason, wire::RefusalReason::encryption_wanted);
  EXPECT_EQ(refusal.client_nonce, 42U);
  EXPECT_THAT(std::string(refusal.text), AllOf(HasSubstr("--key"), HasSubstr("--server-key"), HasSubstr("--psk")));
  EXPECT_EQ(link->counters().hellos_in_clear, 1U);
  EXPECT_EQ(refusals.lines.size(), 1U);
}

TEST_F(InTheClear, HellosAreAnsweredNoMoreOftenThanTheLimit) {
  const Bytes hello = [&] {
    const auto bytes = codec.encode(wire::Hello{.client_nonce = 42, .degrees_of_freedom = 1, .period_s = 1e-3});
    return Bytes(bytes.begin(), bytes.end());
  }();
  for (int i = 0; i < 1000; ++i) arrive(hello);
  EXPECT_EQ(link->counters().in_clear, 1000U);
  EXPECT_EQ(link->counters().hellos_in_clear, 200U);
}

TEST_F(InTheClear, AllElseIsDropped) {
  arrive(codec.encode(wire::Bye{.session = 1}));
  arrive(codec.encode(wire::MotionSample{.session = 1, .sequence = 1, .position = control::Vector::Zero(1)}));
  arrive(bytes_of("FB"));
  arrive({});
  arrive(Bytes(net::kDatagramBytesMax));
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_EQ(link->counters().in_clear, 5U);
  EXPECT_EQ(link->counters().hellos_in_clear, 0U);
  EXPECT_THAT(link->counters().text(), HasSubstr("datagrams in the clear: 5 dropped"));
}

}  // namespace
}  // namespace forcebound::server
