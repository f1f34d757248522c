#include "forcebound/wire/codec.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/unit/wire/sample_messages.hpp"

namespace forcebound::wire {
namespace {

std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  char pair[3];
  for (const std::byte byte : bytes) {
    std::snprintf(pair, sizeof pair, "%02x", std::to_integer<unsigned>(byte));
    text += pair;
  }
  return text;
}

// The format in bytes. If this test fails, programs of different versions no longer understand each other: raise
// kProtocolVersion instead of changing the bytes here.
TEST(Codec, KeepsItsBytes) {
  Codec codec;
  EXPECT_EQ(hex(codec.encode(MotionSample{.session = 0x1122334455667788,
                                          .sequence = 300,
                                          .device_time = Nanoseconds{1000000},
                                          .position = vector_of({0.25, -2})})),
            "46420104"
            "e19b093b"
            "098877665544332211"
            "10ac02"
            "18c0843d"
            "2210000000000000d03f00000000000000c0");
}

/// Hex digits as bytes, with zeros up to that length.
std::vector<std::byte> bytes_of(std::string_view digits, std::size_t bytes) {
  std::vector<std::byte> result(bytes);
  for (std::size_t i = 0; 2 * i < digits.size(); ++i) {
    result[i] = std::byte(std::stoi(std::string(digits.substr(2 * i, 2)), nullptr, 16));
  }
  return result;
}

// The next two are datagrams of a program of version 1: each end must understand why it is refused, so no version may
// change the frame, a Hello's length and fields 1, 2 and 8, or a Refusal's fields 1 to 6.
TEST(Codec, ReadsAHelloOfVersion1) {
  const auto hello = bytes_of(
      "464201016f44c2a0080111efcdab8967452301180322046f6d6e6929fca9f1d24d62503f316666666666660a403a06737068657265"
      "40f4ffffffffffffffff014880dac4095204776176657ae208",
      1200);
  Codec codec;
  const auto read = std::get<Hello>(std::get<Message>(codec.decode(hello)));
  EXPECT_EQ(read.protocol_version, 1u);
  EXPECT_EQ(read.client_nonce, 0x0123456789abcdefu);
  EXPECT_EQ(read.device, "omni");
  EXPECT_EQ(read.scene, "sphere");
  EXPECT_EQ(read.server_law, "wave");
}

TEST(Codec, ReadsARefusalOfVersion1ThatDoesNotSayItsVersion) {
  const auto refusal = bytes_of(
      "464201035715bd0b09efcdab896745230118012233746869732073657276657220737065616b732070726f746f636f6c2076657273696f6e"
      "20312c2074686520636c69656e742032",
      72);
  Codec codec;
  const auto read = std::get<Refusal>(std::get<Message>(codec.decode(refusal)));
  EXPECT_EQ(read.client_nonce, 0x0123456789abcdefu);
  EXPECT_EQ(read.reason, RefusalReason::version_mismatch);
  EXPECT_EQ(read.text, "this server speaks protocol version 1, the client 2");
  EXPECT_EQ(read.protocol_version, 0u);
}

// What a program of version 1 reads: its fields 1, 3 and 4, before the new one.
TEST(Codec, KeepsTheBytesOfARefusalThatTellsAnotherVersionWhy) {
  Codec codec;
  EXPECT_EQ(hex(codec.encode(Refusal{.client_nonce = 0x0123456789abcdef,
                                     .reason = RefusalReason::version_mismatch,
                                     .text = "why",
                                     .protocol_version = 2})),
            "46420103"
            "e71a1c31"
            "09efcdab8967452301"
            "1801"
            "2203776879"
            "3002");
}

TEST(Codec, NumbersItsKindsAsTheyStandInMessage) {
  Codec codec;
  const auto messages = one_of_each();
  for (std::size_t i = 0; i < messages.size(); ++i) {
    ASSERT_EQ(messages[i].index(), i);
    EXPECT_EQ(std::to_integer<std::size_t>(codec.encode(messages[i])[3]), i + 1);
  }
}

}  // namespace
}  // namespace forcebound::wire
