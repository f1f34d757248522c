#include "forcebound/client/commands/doctor/padded.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "forcebound/wire/codec.hpp"

namespace forcebound::client::commands {
namespace {

wire::MotionSample some_motion() {
  wire::MotionSample motion{.session = 7, .sequence = 3, .device_time = time::Nanoseconds{123456789}};
  motion.position = control::Vector::Constant(3, 0.25);
  return motion;
}

TEST(Padded, IsReadAsTheMotionThatItWasWhateverItsSize) {
  wire::Codec client;
  wire::Codec server;
  const std::span<const std::byte> motion = client.encode(some_motion());
  for (std::size_t bytes = motion.size() + 3; bytes <= wire::kFrameBytesMax; ++bytes) {
    const auto longer = padded(motion, bytes);
    ASSERT_TRUE(longer) << bytes;
    ASSERT_EQ(longer->size(), bytes);
    const auto decoded = server.decode(*longer);
    const auto* const message = std::get_if<wire::Message>(&decoded);
    ASSERT_NE(message, nullptr) << bytes;
    const auto& read = std::get<wire::MotionSample>(*message);
    EXPECT_EQ(read.session, 7U);
    EXPECT_EQ(read.sequence, 3U);
    EXPECT_EQ(read.device_time, time::Nanoseconds{123456789});
    EXPECT_TRUE(read.position == some_motion().position);
  }
}

TEST(Padded, LeavesADatagramOfThatSizeAsItIs) {
  wire::Codec client;
  const std::span<const std::byte> motion = client.encode(some_motion());
  const auto same = padded(motion, motion.size());
  ASSERT_TRUE(same);
  EXPECT_TRUE(std::equal(same->begin(), same->end(), motion.begin(), motion.end()));
}

TEST(Padded, RefusesSizesThatCannotBe) {
  wire::Codec client;
  const std::span<const std::byte> motion = client.encode(some_motion());
  EXPECT_FALSE(padded(motion, motion.size() - 1));
  EXPECT_FALSE(padded(motion, motion.size() + 1));
  EXPECT_FALSE(padded(motion, motion.size() + 2));
  EXPECT_FALSE(padded(motion, wire::kFrameBytesMax + 1));
  EXPECT_FALSE(padded(motion.first(7), 100));
}

}  // namespace
}  // namespace forcebound::client::commands
