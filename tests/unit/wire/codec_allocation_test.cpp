#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "forcebound/wire/codec.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/wire/sample_messages.hpp"

namespace forcebound::wire {
namespace {

TEST(Codec, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Codec codec;
  const std::string text(2 * kTextBytesMax, 'x');
  auto messages = one_of_each();
  std::get<Hello>(messages[0]).device = text;
  std::get<Hello>(messages[0]).scene = text;
  std::get<Welcome>(messages[1]).simulated = text;
  std::get<Welcome>(messages[1]).scene = text;
  std::get<Refusal>(messages[2]).text = text;
  std::get<MotionSample>(messages[3]).position = vector_of({1, 2, 3, 4, 5, 6});

  std::vector<std::byte> received(kFrameBytesMax);
  const test::AllocationGuard guard;
  std::size_t decoded = 0;
  for (const Message& message : messages) {
    const auto datagram = codec.encode(message);
    std::copy(datagram.begin(), datagram.end(), received.begin());
    const auto back = codec.decode(std::span{received}.first(datagram.size()));
    if (std::holds_alternative<Message>(back)) ++decoded;
    received[10] ^= std::byte{1};
    (void)codec.decode(std::span{received}.first(datagram.size()));
  }
  EXPECT_EQ(guard.heap_operations(), 0u);
  EXPECT_EQ(decoded, messages.size());
}

TEST(Codec, AllocatesWhenItIsMadeSoThatTheHookIsKnownToWork) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  const Codec codec;
  EXPECT_GT(guard.heap_operations(), 10u);
}

}  // namespace
}  // namespace forcebound::wire
