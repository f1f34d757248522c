#include "forcebound/record/internal/recording_codec.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace forcebound::record {
namespace {

template <class Value>
std::string refusal_of(const std::string& bytes) {
  try {
    Value value;
    decode(bytes, value);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(RecordingCodec, KeepsMotionsWithNumbersThatAreNotFinite) {
  wire::MotionSample motion{.session = 1, .sequence = 2, .device_time = Nanoseconds{3}};
  motion.position = control::Vector::Constant(6, std::numeric_limits<double>::infinity());
  motion.server_law_numbers = control::ServerLawNumbers::Constant(16, 0.5);
  wire::MotionSample back{.session = 9, .server_law_numbers = control::ServerLawNumbers::Ones(3)};
  decode(encode(motion), back);
  EXPECT_EQ(back.session, 1U);
  EXPECT_EQ(back.sequence, 2U);
  EXPECT_EQ(back.device_time, Nanoseconds{3});
  EXPECT_EQ(back.position, motion.position);
  EXPECT_EQ(back.server_law_numbers, motion.server_law_numbers);
}

TEST(RecordingCodec, TellsWholeTrustInModelsFromNoModels) {
  TickRecord tick;
  tick.model_trust = 1;
  TickRecord back;
  decode(encode(tick), back);
  EXPECT_EQ(back.model_trust, 1);
  decode(encode(TickRecord{}), back);
  EXPECT_EQ(back.model_trust, std::nullopt);
}

TEST(RecordingCodec, NamesATimeOutOfRange) {
  const wire::MotionSample motion{.device_time = wire::kTimeMost + Nanoseconds{1}};
  EXPECT_EQ(refusal_of<wire::MotionSample>(encode(motion)),
            "device_time_ns must be within 2^61, got 2305843009213693953");
  const wire::EnvironmentForce force{.compute_time = -wire::kTimeMost - Nanoseconds{1}};
  EXPECT_EQ(refusal_of<ForceRecord>(encode(SentForceRecord{force})),
            "compute_time_ns must be within 2^61, got -2305843009213693953");
}

TEST(RecordingCodec, NamesTheVectorWithMoreRowsThanAnyDevice) {
  const std::string seven = "\x22\x38" + std::string(56, '\0');  // position_m, field 4: seven numbers of zero
  EXPECT_EQ(refusal_of<wire::MotionSample>(seven), "position_m must have at most 6 rows, got 7");
}

}  // namespace
}  // namespace forcebound::record
