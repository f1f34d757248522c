#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <string>
#include <vector>

#include "forcebound/wire/codec.hpp"
#include "tests/unit/wire/sample_messages.hpp"

namespace {
long allocations = 0;
}  // namespace

void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
  throw std::bad_alloc{};
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace forcebound::wire {
namespace {

TEST(Codec, DoesNotAllocate) {
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
  const long before = allocations;
  std::size_t decoded = 0;
  for (const Message& message : messages) {
    const auto datagram = codec.encode(message);
    std::copy(datagram.begin(), datagram.end(), received.begin());
    const auto back = codec.decode(std::span{received}.first(datagram.size()));
    if (std::holds_alternative<Message>(back)) ++decoded;
    received[10] ^= std::byte{1};
    (void)codec.decode(std::span{received}.first(datagram.size()));
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_EQ(decoded, messages.size());
}

TEST(Codec, AllocatesWhenItIsMadeSoThatTheHookIsKnownToWork) {
  const long before = allocations;
  const Codec codec;
  EXPECT_GT(allocations - before, 10);
}

}  // namespace
}  // namespace forcebound::wire
