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

/// A body of so many copies of some bytes.
Bytes copies(int count, const Bytes& of) {
  Bytes all;
  all.reserve(static_cast<std::size_t>(count) * of.size());
  for (int i = 0; i < count; ++i) all.insert(all.end(), of.begin(), of.end());
  return all;
}

/// The tag of a field, and its value.
Bytes field(unsigned number, unsigned wire_type, const Bytes& value) {
  const unsigned tag = 8 * number + wire_type;
  Bytes bytes{static_cast<std::byte>(0x80U | (tag & 0x7FU)), static_cast<std::byte>(tag >> 7U)};
  bytes.insert(bytes.end(), value.begin(), value.end());
  return bytes;
}

TEST(Codec, DoesNotAllocateWhateverSomebodySends) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  constexpr std::byte kNothing{0};
  constexpr std::byte kTwoBytes{2};
  constexpr std::byte kInvalid{0xFF};
  const Bytes packed_floats(280 * sizeof(float));
  Bytes force_of_a_model{std::byte{0x12}, std::byte{0xE0}, std::byte{0x08}};  // field 2, 1,120 bytes
  force_of_a_model.insert(force_of_a_model.end(), packed_floats.begin(), packed_floats.end());
  Bytes long_model{std::byte{0xE3}, std::byte{0x08}};  // 1,123 bytes
  long_model.insert(long_model.end(), force_of_a_model.begin(), force_of_a_model.end());
  std::vector<Bytes> datagrams{
      framed(5, copies(380, field(22, 2, {kNothing}))),                                     // surfaces without anything
      framed(5, copies(380, field(23, 2, {kNothing}))),                                     // masses
      framed(5, copies(380, field(24, 2, {kNothing}))),                                     // fields
      framed(5, field(22, 2, long_model)),                                                  // 280 numbers of a force
      framed(5, copies(200, field(22, 2, {kTwoBytes, std::byte{0xF8}, std::byte{0x01}}))),  // a field without a value
      framed(5, copies(150, field(22, 2, {kTwoBytes, std::byte{0x78}, kNothing}))),         // of unknown number
      framed(5, copies(300, field(100, 0, {kNothing}))),                                    // unknown numbers
      framed(5, copies(200, field(100, 2, {kTwoBytes, kNothing, kNothing}))),               // and texts
      framed(5, copies(200, field(22, 0, {kNothing}))),         // numbers where models are expected
      framed(2, field(4, 2, {kTwoBytes, kInvalid, kInvalid})),  // a name that is not UTF-8
      framed(6, copies(300, field(100, 0, {kNothing}))),
  };
  Codec codec;
  const test::AllocationGuard guard;
  for (const Bytes& datagram : datagrams) (void)codec.decode(datagram);
  EXPECT_EQ(guard.heap_operations(), 0u);
}

TEST(Codec, AllocatesWhenItIsMadeSoThatTheHookIsKnownToWork) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  const Codec codec;
  EXPECT_GT(guard.heap_operations(), 10u);
}

}  // namespace
}  // namespace forcebound::wire
