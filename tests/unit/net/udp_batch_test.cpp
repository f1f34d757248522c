#include "forcebound/net/udp_batch.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/becomes_true.hpp"

namespace forcebound::net {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

std::span<const std::byte> batch_bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

/// A batch at one end, three plain links at the other.
class UdpBatchTest : public testing::Test {
 protected:
  std::vector<std::string> texts() {
    const int descriptor = link_.descriptor();
    wait_readable({&descriptor, 1}, 5s);
    std::vector<std::string> all;
    for (const auto& [bytes, received] : batch_.receive_all()) {
      all.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    return all;
  }

  static std::string heard(UdpLink& link) {
    const int descriptor = link.descriptor();
    if (!wait_readable({&descriptor, 1}, 5s)) return "nothing";
    std::vector<std::byte> buffer(kDatagramBytesMax);
    const auto received = link.receive(buffer);
    return received ? std::string(reinterpret_cast<const char*>(buffer.data()), received->bytes) : "nothing";
  }

  UdpLink link_ = UdpLink::listen(resolve({"127.0.0.1", 0}));
  UdpBatch batch_{link_};
  Address address_ = link_.local_address();
  UdpLink first_ = UdpLink::towards(address_);
  UdpLink second_ = UdpLink::towards(address_);
};

TEST_F(UdpBatchTest, ReceivesWhatWaitsInItsOrderAndKnowsEachSender) {
  first_.send(batch_bytes("one"), address_);
  second_.send(batch_bytes("two"), address_);
  first_.send({}, address_);
  EXPECT_THAT(texts(), ElementsAre("one", "two", ""));
  first_.send(batch_bytes("x"), address_);
  second_.send(batch_bytes("y"), address_);
  const auto arrived = batch_.receive_all();
  ASSERT_EQ(arrived.size(), 2U);
  EXPECT_EQ(arrived[0].received.from, first_.local_address());
  EXPECT_EQ(arrived[1].received.from, second_.local_address());
  EXPECT_THAT(batch_.receive_all(), IsEmpty());
}

TEST_F(UdpBatchTest, SleepsForTheFirstAloneAndNotForever) {
  link_.wait_at_most(10ms);
  EXPECT_THAT(batch_.wait_for_some(), IsEmpty());
  std::jthread late([&] {
    std::this_thread::sleep_for(20ms);
    first_.send(batch_bytes("late"), address_);
  });
  link_.wait_at_most(5s);
  const auto arrived = batch_.wait_for_some();
  ASSERT_EQ(arrived.size(), 1U);
  EXPECT_EQ(arrived.front().received.from, first_.local_address());
  EXPECT_THAT(batch_.receive_all(), IsEmpty());
}

TEST_F(UdpBatchTest, LeavesWhatIsTooMuchForTheNextTime) {
  for (int i = 0; i < 40; ++i) first_.send(batch_bytes(std::to_string(i)), address_);
  EXPECT_EQ(texts().size(), UdpBatch::kDatagramsMax);
  EXPECT_EQ(texts().front(), "32");
}

TEST_F(UdpBatchTest, CutsOversizeDatagramsAndTellsTheirSize) {
  first_.send(batch_bytes(std::string(9000, 'x')), address_);
  const int descriptor = link_.descriptor();
  wait_readable({&descriptor, 1}, 5s);
  const auto arrived = batch_.receive_all();
  ASSERT_EQ(arrived.size(), 1U);
  EXPECT_EQ(arrived[0].received.bytes, 9000U);
  EXPECT_EQ(arrived[0].bytes.size(), kDatagramBytesMax);
}

TEST_F(UdpBatchTest, TellsHowLongADatagramWaited) {
  const int descriptor = link_.descriptor();
  const auto is_stamped = [&] {
    first_.send(batch_bytes("is it?"), address_);
    return wait_readable({&descriptor, 1}, 5s) && batch_.receive_all().front().received.waited > 0ns;
  };
  EXPECT_TRUE(test::becomes_true(is_stamped)) << "the kernel begins a moment after a socket asked for it";
  const auto sent = std::chrono::steady_clock::now();
  first_.send(batch_bytes("x"), address_);
  std::this_thread::sleep_for(20ms);
  const auto arrived = batch_.receive_all();
  ASSERT_EQ(arrived.size(), 1U);
  EXPECT_GE(arrived[0].received.waited, 15ms);
  EXPECT_LE(arrived[0].received.waited, std::chrono::steady_clock::now() - sent + 5ms);
}

TEST(UdpBatch, KnowsNoWaitingWithoutStamps) {
  UdpLink link = UdpLink::listen(resolve({"127.0.0.1", 0}), UdpLink::Stamps::left_out);
  UdpBatch batch(link);
  UdpLink peer = UdpLink::towards(link.local_address());
  peer.send(batch_bytes("x"), link.local_address());
  link.wait_at_most(5s);
  const auto arrived = batch.wait_for_some();
  ASSERT_EQ(arrived.size(), 1U);
  EXPECT_EQ(arrived[0].received.waited, 0ns);
}

TEST_F(UdpBatchTest, SendsNothingBeforeTheFlushAndThenEachToItsAddress) {
  EXPECT_TRUE(batch_.send(batch_bytes("for the first"), first_.local_address()));
  EXPECT_TRUE(batch_.send(batch_bytes("for the second"), second_.local_address()));
  std::vector<std::byte> buffer(kDatagramBytesMax);
  EXPECT_FALSE(first_.receive(buffer));
  batch_.flush();
  EXPECT_EQ(heard(first_), "for the first");
  EXPECT_EQ(heard(second_), "for the second");
}

TEST_F(UdpBatchTest, FlushesByItselfWhereThereIsNoRoomForMore) {
  for (std::size_t i = 0; i <= UdpBatch::kDatagramsMax; ++i) {
    EXPECT_TRUE(batch_.send(batch_bytes(std::to_string(i)), first_.local_address()));
  }
  for (std::size_t i = 0; i < UdpBatch::kDatagramsMax; ++i) EXPECT_EQ(heard(first_), std::to_string(i));
  batch_.flush();
  EXPECT_EQ(heard(first_), std::to_string(UdpBatch::kDatagramsMax));
}

TEST_F(UdpBatchTest, CountsWhatTheSystemDoesNotTakeAndSendsTheRest) {
  EXPECT_TRUE(batch_.send(batch_bytes("nowhere"), resolve({"::1", 9})));  // this socket is of IPv4
  EXPECT_TRUE(batch_.send(batch_bytes("here"), first_.local_address()));
  batch_.flush();
  EXPECT_EQ(heard(first_), "here");
  EXPECT_EQ(link_.counters().send_failed, 1U);
  EXPECT_FALSE(batch_.send(std::vector<std::byte>(kDatagramBytesMax + 1), first_.local_address()));
}

TEST_F(UdpBatchTest, CountsWhatASlowReaderMakesTheSystemDrop) {
  std::uint64_t sent = 0;
  for (int i = 0; i < 20'000; ++i) sent += first_.send(batch_bytes("x"), address_);
  std::uint64_t received = 0;
  for (auto arrived = batch_.receive_all(); !arrived.empty(); arrived = batch_.receive_all())
    received += arrived.size();
  EXPECT_EQ(link_.counters().overflowed, sent - received);
  EXPECT_GT(link_.counters().overflowed, 0U);
}

TEST_F(UdpBatchTest, ReceivesInSpiteOfPortUnreachableErrors) {
  auto peer = std::make_optional(UdpLink::listen(resolve({"127.0.0.1", 0})));
  const Address there = peer->local_address();
  UdpLink link = UdpLink::towards(there);
  UdpBatch batch(link);
  peer.reset();
  batch.send(batch_bytes("anybody?"), there);
  batch.flush();
  const int descriptor = link.descriptor();
  wait_readable({&descriptor, 1}, 5s);
  EXPECT_THAT(batch.receive_all(), IsEmpty());
  EXPECT_EQ(link.counters().refused, 1U);
}

TEST_F(UdpBatchTest, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const int descriptor = link_.descriptor();
  const test::AllocationGuard guard;
  for (int i = 0; i < 50; ++i) {
    first_.send(batch_bytes("motion"), address_);
    wait_readable({&descriptor, 1}, 5s);
    for (const auto& arrived : batch_.receive_all()) batch_.send(arrived.bytes, arrived.received.from);
    batch_.flush();
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(heard(first_), "motion");
}

}  // namespace
}  // namespace forcebound::net
