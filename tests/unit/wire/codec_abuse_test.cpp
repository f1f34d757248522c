#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "forcebound/wire/codec.hpp"
#include "tests/unit/wire/sample_messages.hpp"

namespace forcebound::wire {
namespace {

Bytes copy(std::span<const std::byte> datagram) { return {datagram.begin(), datagram.end()}; }

std::optional<Malformed> refused(Codec& codec, std::span<const std::byte> datagram) {
  const auto decoded = codec.decode(datagram);
  const auto* reason = std::get_if<Malformed>(&decoded);
  return reason == nullptr ? std::nullopt : std::optional{*reason};
}

Bytes body_of(const Bytes& datagram) { return {datagram.begin() + 8, datagram.end()}; }

TEST(CodecAbuse, TruncationAtEveryLengthIsCaught) {
  Codec codec;
  for (const Message& message : one_of_each()) {
    const Bytes whole = copy(codec.encode(message));
    for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
      EXPECT_EQ(refused(codec, std::span{whole}.first(bytes)), bytes < 8 ? Malformed::truncated : Malformed::corrupt)
          << "kind " << message.index() << " cut to " << bytes;
    }
  }
}

TEST(CodecAbuse, EveryFlippedBitIsCaught) {
  Codec codec;
  for (const Message& message : one_of_each()) {
    Bytes bytes = copy(codec.encode(message));
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      const std::byte flip{static_cast<unsigned char>(1U << bit % 8)};
      bytes[bit / 8] ^= flip;
      EXPECT_EQ(refused(codec, bytes), bit < 24 ? Malformed::foreign : Malformed::corrupt)
          << "kind " << message.index() << " bit " << bit;
      bytes[bit / 8] ^= flip;
    }
  }
}

TEST(CodecAbuse, OversizeIsCaughtBeforeItIsRead) {
  Codec codec;
  Bytes bytes = copy(codec.encode(Hello{}));
  bytes.push_back(std::byte{0});
  EXPECT_EQ(refused(codec, bytes), Malformed::oversize);
  EXPECT_EQ(refused(codec, Bytes(65507)), Malformed::oversize);
}

TEST(CodecAbuse, ForeignDatagramsAreCaught) {
  Codec codec;
  EXPECT_EQ(refused(codec, Bytes(100)), Malformed::foreign);
  Bytes newer = copy(codec.encode(Bye{}));
  newer[2] = std::byte{2};
  EXPECT_EQ(refused(codec, newer), Malformed::foreign);
}

TEST(CodecAbuse, UnknownKindsAreUnreadable) {
  Codec codec;
  for (const unsigned kind : {0U, 9U, 10U, 255U}) EXPECT_EQ(refused(codec, framed(kind, {})), Malformed::unreadable);
}

TEST(CodecAbuse, ShortHelloIsUnreadableAsItsAnswerWouldBeLarger) {
  Codec codec;
  const Bytes body = body_of(copy(codec.encode(Hello{.client_nonce = 3, .device = "omni"})));
  EXPECT_EQ(refused(codec, framed(1, body)), std::nullopt);
  const std::size_t without_padding = 2 + 9 + 6;
  EXPECT_EQ(refused(codec, framed(1, {body.begin(), body.begin() + without_padding})), Malformed::unreadable);
}

TEST(CodecAbuse, MotionWithoutPositionIsUnreadable) {
  Codec codec;
  EXPECT_EQ(refused(codec, copy(codec.encode(MotionSample{.session = 1, .sequence = 1}))), Malformed::unreadable);
}

TEST(CodecAbuse, MoreThanSixRowsAreRefused) {
  Codec codec;
  // Two positions in one body: the lists of a repeated field are joined.
  const Bytes four = body_of(copy(codec.encode(MotionSample{.position = vector_of({1, 2, 3, 4})})));
  Bytes eight = four;
  eight.insert(eight.end(), four.begin(), four.end());
  EXPECT_EQ(refused(codec, framed(4, four)), std::nullopt);
  EXPECT_EQ(refused(codec, framed(4, eight)), Malformed::non_finite);
}

TEST(CodecAbuse, MoreThanSixteenNumbersOfALawAreRefused) {
  Codec codec;
  for (const Message& message :
       {Message{MotionSample{.position = vector_of({1}), .server_law_numbers = server_law_numbers(16)}},
        Message{EnvironmentForce{.server_law_numbers = server_law_numbers(16)}}}) {
    const Bytes body = body_of(copy(codec.encode(message)));
    Bytes twice = body;
    twice.insert(twice.end(), body.begin(), body.end());
    const auto kind = static_cast<unsigned>(message.index() + 1);
    EXPECT_EQ(refused(codec, framed(kind, body)), std::nullopt);
    EXPECT_EQ(refused(codec, framed(kind, twice)), Malformed::non_finite);
  }
}

TEST(CodecAbuse, NonFiniteNumbersAreRefusedInEveryField) {
  Codec codec;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    const auto expect_refused = [&codec](const Message& message) {
      EXPECT_EQ(refused(codec, copy(codec.encode(message))), Malformed::non_finite);
    };
    expect_refused(Hello{.period_s = bad});
    expect_refused(Hello{.force_N_max = bad});
    expect_refused(MotionSample{.position = vector_of({0, bad})});
    expect_refused(
        MotionSample{.position = vector_of({0}), .server_law_numbers = control::ServerLawNumbers::Constant(3, bad)});
    expect_refused(EnvironmentForce{.server_law_numbers = control::ServerLawNumbers::Constant(1, bad)});
    expect_refused(EnvironmentForce{.answer = {.force = vector_of({bad})}});
    expect_refused(EnvironmentForce{.position = vector_of({bad, 0})});
    expect_refused(EnvironmentForce{.answer = {.contact_normal = vector_of({0, 0, bad})}});
    expect_refused(EnvironmentForce{.answer = {.penetration_m = bad}});
    expect_refused(EnvironmentForce{.answer = {.texture_N = bad}});
    expect_refused(EnvironmentForce{.answer = {.texture_wave = vector_of({0, bad})}});
    expect_refused(EnvironmentForce{.answer = {.texture_across = vector_of({bad})}});
  }
}

TEST(CodecAbuse, TextThatIsNotUtf8IsUnreadableAndSilent) {
  Codec codec;
  testing::internal::CaptureStderr();
  EXPECT_EQ(refused(codec, copy(codec.encode(Hello{.device = "\xff\xfe"}))), Malformed::unreadable);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(CodecAbuse, AnUnknownReasonOfANewerServerIsUnspecified) {
  Codec codec;
  const auto decoded = codec.decode(framed(3, {std::byte{0x18}, std::byte{99}}));
  EXPECT_EQ(std::get<Refusal>(std::get<Message>(decoded)).reason, RefusalReason::unspecified);
}

TEST(CodecAbuse, UnknownFieldsOfANewerVersionAreSkipped) {
  Codec codec;
  Bytes body = body_of(copy(codec.encode(Bye{.session = 9, .forces_sent = 4})));
  body.insert(body.end(), {std::byte{0xf8}, std::byte{0x01}, std::byte{5}});  // field 31, varint
  const auto decoded = codec.decode(framed(6, body));
  EXPECT_EQ(std::get<Bye>(std::get<Message>(decoded)).forces_sent, 4u);
}

TEST(CodecAbuse, MoreModelsThanThereIsRoomForMakeAllOfThemUnsound) {
  Codec codec;
  local_model::LocalModel model;
  model.surfaces[0] = test::sample_local_model().surfaces[0];
  model.surface_count = 1;
  const Bytes body = body_of(copy(codec.encode(EnvironmentForce{.session = 9, .answer = {.model = model}})));
  Bytes many = body;
  for (int i = 0; i < 3; ++i) many.insert(many.end(), body.begin(), body.end());
  const auto once = codec.decode(framed(5, body));
  EXPECT_TRUE(local_model::is_sound(std::get<EnvironmentForce>(std::get<Message>(once)).answer.model));
  const auto decoded = codec.decode(framed(5, many));
  EXPECT_FALSE(local_model::is_sound(std::get<EnvironmentForce>(std::get<Message>(decoded)).answer.model));
}

TEST(CodecAbuse, ADecodedMessageLeavesNothingInTheNext) {
  Codec codec;
  const auto messages = one_of_each();
  (void)codec.decode(copy(codec.encode(messages[4])));
  const auto decoded = codec.decode(copy(codec.encode(EnvironmentForce{.session = 1})));
  const auto& force = std::get<EnvironmentForce>(std::get<Message>(decoded));
  EXPECT_EQ(force.answer.force.rows(), 0);
  EXPECT_EQ(force.answer.contact_normal.rows(), 0);
  EXPECT_EQ(force.answer.penetration_m, 0);
}

// Whatever an untrusted client sends is decoded to a message of finite numbers or as a reason.
TEST(CodecAbuse, RandomBytesAreHarmless) {
  Codec codec;
  constexpr unsigned kSeed = 20150301;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<std::size_t> length(0, 200);
  std::uniform_int_distribution<int> byte(0, 255);
  int messages = 0;
  for (int trial = 0; trial < 60000; ++trial) {
    Bytes body(length(random));
    for (std::byte& b : body) b = static_cast<std::byte>(byte(random));
    EXPECT_TRUE(refused(codec, body).has_value());
    const auto decoded = codec.decode(framed(static_cast<unsigned>(trial % 9), body));
    if (const auto* message = std::get_if<Message>(&decoded)) {
      ++messages;
      if (const auto* motion = std::get_if<MotionSample>(message)) {
        EXPECT_TRUE(motion->position.allFinite() && motion->server_law_numbers.allFinite());
      }
    }
  }
  EXPECT_GT(messages, 0) << "no body parses, so the test is void";
}

// Real bodies with one byte replaced, in a valid frame: the nearest inputs for a fuzzer.
TEST(CodecAbuse, RealBodiesWithChangedBytesAreHarmless) {
  Codec codec;
  int messages = 0;
  for (const Message& message : one_of_each()) {
    const Bytes body = body_of(copy(codec.encode(message)));
    for (std::size_t at = 0; at < std::min<std::size_t>(body.size(), 200); ++at) {
      for (const unsigned value : {0x00U, 0x7fU, 0x80U, 0xffU}) {
        Bytes changed = body;
        changed[at] = static_cast<std::byte>(value);
        const auto decoded = codec.decode(framed(static_cast<unsigned>(message.index() + 1), changed));
        const auto* decoded_message = std::get_if<Message>(&decoded);
        if (decoded_message == nullptr) continue;
        ++messages;
        if (const auto* force = std::get_if<EnvironmentForce>(decoded_message)) {
          EXPECT_TRUE(force->answer.force.allFinite() && force->position.allFinite() &&
                      force->answer.contact_normal.allFinite());
          EXPECT_TRUE(force->server_law_numbers.allFinite());
          EXPECT_TRUE(std::isfinite(force->answer.penetration_m));
        }
      }
    }
  }
  EXPECT_GT(messages, 0);
}

TEST(Heading, TellsTheSessionOrTheNonceWithoutTheBody) {
  Codec codec;
  const auto of = [&](const Message& message) { return std::get<Heading>(heading_of(codec.encode(message))); };
  constexpr std::uint64_t kNumber = 0x1234567890abcdef;
  const control::Vector one = control::Vector::Ones(1);
  EXPECT_EQ(of(MotionSample{.session = kNumber, .sequence = 1, .position = one}).session, kNumber);
  EXPECT_EQ(of(EnvironmentForce{.session = kNumber, .sequence = 1, .answer = {.force = one}}).session, kNumber);
  EXPECT_EQ(of(Bye{.session = kNumber, .forces_sent = 5}).session, kNumber);
  EXPECT_EQ(of(ScenePiece{.session = kNumber, .transmission = 1}).session, kNumber);
  EXPECT_EQ(of(Refusal{.session = kNumber, .reason = RefusalReason::unknown_session}).session, kNumber);
  EXPECT_EQ(of(Refusal{.client_nonce = kNumber, .reason = RefusalReason::server_full}).client_nonce, kNumber);
  EXPECT_EQ(of(Welcome{.client_nonce = kNumber, .session = 1}).client_nonce, kNumber);
  EXPECT_TRUE(of(Hello{.client_nonce = kNumber}).is<Hello>());
  EXPECT_EQ(of(Bye{}).session, 0U);
}

TEST(Heading, OfWhatHasTheWrongChecksumIsNone) {
  Codec codec;
  const auto encoded = codec.encode(Bye{.session = 5});
  std::vector<std::byte> bytes(encoded.begin(), encoded.end());
  bytes.back() ^= std::byte{1};
  EXPECT_EQ(std::get<Malformed>(heading_of(bytes)), Malformed::corrupt);
}

}  // namespace
}  // namespace forcebound::wire
