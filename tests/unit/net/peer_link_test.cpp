#include "forcebound/net/peer_link.hpp"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <functional>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <semaphore>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/ipv6.hpp"

namespace forcebound::net {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Endpoint kName{"haptics.example", 47800};

/// A name server whose answers the test sets. A lookup's thread may ask it after the lookup's end.
class Names {
 public:
  void lead_to(std::vector<Address> addresses) {
    const std::scoped_lock lock(shared_->mutex);
    shared_->addresses = std::move(addresses);
  }
  [[nodiscard]] int asked() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->asked;
  }
  [[nodiscard]] Resolver resolver() const {
    return [shared = shared_](const Endpoint& endpoint) {
      const std::scoped_lock lock(shared->mutex);
      ++shared->asked;
      if (shared->addresses.empty()) throw std::runtime_error("nobody knows '" + endpoint.host + "'");
      return shared->addresses;
    };
  }

 private:
  struct Shared {
    std::mutex mutex;
    std::vector<Address> addresses;
    int asked = 0;
  };
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

/// A server on loopback.
struct AtAddress {
  explicit AtAddress(const char* host, std::uint16_t port = 0) : link(UdpLink::listen(resolve({host, port}))) {}

  [[nodiscard]] Address address() const { return link.local_address(); }

  /// Takes all that has come, and answers the last of it. False: nothing had come.
  bool answer() {
    std::array<std::byte, 16> buffer{};
    std::optional<Received> last;
    while (const auto received = link.receive(buffer)) last = received;
    return last && link.send(std::as_bytes(std::span("a", 1)), last->from);
  }

  UdpLink link;
};

class PeerLinkTest : public testing::Test {
 protected:
  void start(PeerLink::Found found = PeerLink::Found::by_session) {
    lookup_.emplace(kName, names_.resolver());
    link_.emplace(*lookup_, clock_, found);
  }

  bool ask() { return link_->send(std::as_bytes(std::span("q", 1)), PeerLink::kPeer); }

  bool is_answered() {
    std::array<std::byte, 16> buffer{};
    const auto received = link_->receive(buffer);
    if (received) {
      EXPECT_EQ(received->from, PeerLink::kPeer);
    }
    return received.has_value();
  }

  /// Until a question has come to one of them, or the link has an answer or a refusal.
  void wait_for_any(std::initializer_list<const AtAddress*> servers) const {
    std::vector<int> descriptors{link_->descriptor()};
    for (const AtAddress* server : servers) descriptors.push_back(server->link.descriptor());
    wait_readable(descriptors, 5s);
  }

  /// Asks every 50 ms.
  /// @param servers all that may be asked @param answer whether one of them answered
  /// @return whether an answer came within the duration
  bool received_within(time::Nanoseconds duration, std::initializer_list<const AtAddress*> servers,
                       const std::function<bool()>& answer) {
    for (const auto end = clock_.time + duration; clock_.time < end;) {
      clock_.time += 50ms;
      if (ask()) wait_for_any(servers);
      if (answer()) wait_for_any({});
      if (is_answered()) return true;
    }
    return false;
  }

  /// The lookup's thread pauses in real time, however much of the clock's passes meanwhile.
  bool is_heard_at_last(std::initializer_list<const AtAddress*> servers, const std::function<bool()>& answer) {
    return test::becomes_true([&] { return received_within(50ms, servers, answer); });
  }

  Names names_;
  test::FakeClock clock_;
  std::optional<NameLookup> lookup_;
  std::optional<PeerLink> link_;
};

TEST_F(PeerLinkTest, FindsTheOneOfBothKindsOfAddressThatAnswers) {
  if (!test::machine_has_ipv6()) GTEST_SKIP() << "this machine has no IPv6";
  for (const bool on_ipv6 : {true, false}) {
    AtAddress v4("127.0.0.1");
    AtAddress v6("::1");
    names_.lead_to(in_order_of_trial({v4.address(), v6.address()}));
    start();
    AtAddress& server = on_ipv6 ? v6 : v4;
    EXPECT_TRUE(received_within(3s, {&v4, &v6}, [&] { return server.answer(); })) << "IPv6: " << on_ipv6;
    link_->keep();
    EXPECT_EQ(link_->take_news(), "haptics.example:47800 is at " + to_string(server.address()));
    EXPECT_EQ(link_->take_news(), "");
  }
}

TEST_F(PeerLinkTest, GoesOnAtOnceWhereNobodyIs) {
  AtAddress server("127.0.0.1");
  const Address nobody{.ip = resolve({"::1", 0}).ip, .port = server.address().port};
  names_.lead_to({nobody, server.address()});
  start();
  EXPECT_TRUE(received_within(250ms, {&server}, [&] { return server.answer(); })) << "less than a turn";
}

TEST_F(PeerLinkTest, FindsAServerThatHasMoved) {
  AtAddress before("127.0.0.1");
  AtAddress after("127.0.0.2");
  names_.lead_to({before.address()});
  start();
  ASSERT_TRUE(received_within(1s, {&before, &after}, [&] { return before.answer(); }));
  link_->keep();
  names_.lead_to({after.address()});
  const int asked = names_.asked();
  EXPECT_FALSE(received_within(900ms, {&before, &after}, [&] { return after.answer(); }));
  EXPECT_EQ(names_.asked(), asked) << "a short silence is no reason to ask";
  EXPECT_TRUE(is_heard_at_last({&before, &after}, [&] { return after.answer(); }));
  EXPECT_GT(names_.asked(), asked);
}

TEST_F(PeerLinkTest, FindsAServerWhoseNameHasNoAddressYet) {
  start();
  EXPECT_FALSE(link_->ready());
  EXPECT_EQ(lookup_->in_words(), "haptics.example:47800 (nobody knows 'haptics.example')");
  EXPECT_FALSE(received_within(500ms, {}, [] { return false; }));
  AtAddress server("127.0.0.1");
  names_.lead_to({server.address()});
  EXPECT_TRUE(is_heard_at_last({&server}, [&] { return server.answer(); }));
  EXPECT_TRUE(link_->ready());
  EXPECT_EQ(lookup_->in_words(), "haptics.example:47800 (at " + to_string(server.address()) + ")");
}

TEST_F(PeerLinkTest, LeavesAnAddressThatAnswersWithoutASession) {
  AtAddress another("127.0.0.1");
  AtAddress server("127.0.0.2");
  names_.lead_to({another.address(), server.address()});
  start();
  const auto end = clock_.time + 20s;
  bool found = false;
  while (!found && clock_.time < end) {
    (void)received_within(50ms, {&another, &server}, [&] {
      found = server.answer();
      return another.answer() || found;
    });
  }
  EXPECT_TRUE(found);
}

TEST_F(PeerLinkTest, StaysWithAnyAnswerIfThatCounts) {
  AtAddress first("127.0.0.1");
  AtAddress second("127.0.0.2");
  names_.lead_to({first.address(), second.address()});
  start(PeerLink::Found::by_answer);
  bool left = false;
  for (const auto end = clock_.time + 20s; clock_.time < end;) {
    EXPECT_TRUE(received_within(1s, {&first, &second}, [&] {
      left = left || second.answer();
      return first.answer();
    }));
  }
  EXPECT_FALSE(left);
}

TEST_F(PeerLinkTest, TakesNothingThatAnAddressOfBeforeHasSent) {
  AtAddress before("127.0.0.1");
  AtAddress after("127.0.0.2");
  names_.lead_to({before.address(), after.address()});
  start();
  ASSERT_TRUE(ask());
  wait_for_any({&before});
  ASSERT_TRUE(before.answer());
  wait_for_any({});
  clock_.time += 300ms;
  ASSERT_TRUE(ask());
  EXPECT_FALSE(is_answered());
}

TEST_F(PeerLinkTest, DoesNotAllocateOrWaitWhileItSearches) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  AtAddress first("127.0.0.1");
  AtAddress second("127.0.0.2");
  names_.lead_to({first.address(), second.address()});
  start();
  std::array<std::byte, 16> buffer{};
  const test::AllocationGuard guard;
  for (int i = 0; i < 1000; ++i) {
    clock_.time += 10ms;
    (void)link_->send(std::as_bytes(std::span("q", 1)), PeerLink::kPeer);
    (void)link_->receive(buffer);
  }
  link_->keep();
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(NameLookup, DoesNotWaitAtItsEndForALookupUnderWay) {
  struct NameServer {
    std::binary_semaphore asked{0};
    std::binary_semaphore answers{0};
    bool at_first = true;
  };
  const auto server = std::make_shared<NameServer>();
  {
    NameLookup lookup(kName, [server](const Endpoint&) -> std::vector<Address> {
      if (!std::exchange(server->at_first, false)) {
        server->asked.release();
        server->answers.acquire();
      }
      return {{.ip = {1}, .port = 1}};
    });
    lookup.ask();
    server->asked.acquire();
  }
  server->answers.release();
}

TEST(NameLookup, AsksNobodyForAnAddressInDigits) {
  int asked = 0;
  NameLookup lookup({"127.0.0.1", 1}, [&asked](const Endpoint& endpoint) {
    ++asked;
    return look_up(endpoint);
  });
  lookup.ask();
  std::this_thread::sleep_for(5ms);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(lookup.in_words(), "127.0.0.1:1");
}

TEST(NameLookup, PassesOnThatAPeerIsNotAccepted) {
  const auto refuse = [](const Endpoint&) -> std::vector<Address> { throw std::invalid_argument("not there"); };
  EXPECT_THAT([&] { const NameLookup lookup(kName, refuse); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not there")));
}

TEST(PeerLink, NamesTheAddressInDigitsToWhichThereIsNoWay) {
  const test::FakeClock clock;
  NameLookup lookup({"192.0.2.1", 1},
                    [](const Endpoint&) -> std::vector<Address> { throw std::runtime_error("no way"); });
  EXPECT_THAT([&] { const PeerLink link(lookup, clock, PeerLink::Found::by_answer); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no way")));
}

}  // namespace
}  // namespace forcebound::net
