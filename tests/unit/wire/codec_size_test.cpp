#include "forcebound/wire/codec.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <string>

#include "tests/unit/wire/any_message.hpp"

namespace forcebound::wire {
namespace {

TEST(Codec, AnswersAreNeverLargerThanHello) {
  Codec codec;
  const std::string endless(5000, 'x');
  const std::size_t empty = codec.encode(Hello{}).size();
  EXPECT_EQ(empty, kFrameBytesMax);
  EXPECT_EQ(codec
                .encode(Hello{.protocol_version = ~0u,
                              .client_nonce = ~0ull,
                              .degrees_of_freedom = ~0u,
                              .device = endless,
                              .period_s = 1,
                              .force_N_max = 1,
                              .scene = endless,
                              .client_time = kTimeMost,
                              .round_trip = -kTimeMost,
                              .server_law = endless})
                .size(),
            kFrameBytesMax);
  EXPECT_LE(codec
                .encode(Welcome{.client_nonce = ~0ull,
                                .session = ~0ull,
                                .scene_hash = ~0ull,
                                .scene = endless,
                                .simulated = endless,
                                .offer = {.manifest_sha256 = {}, .manifest_bytes = ~0u, .pieces = ~0u},
                                .server_parts = ServerParts::none})
                .size(),
            kFrameBytesMax);
  EXPECT_LE(codec
                .encode(Refusal{.client_nonce = ~0ull,
                                .session = ~0ull,
                                .reason = RefusalReason::wrong_degrees_of_freedom,
                                .text = endless,
                                .client_time = -kTimeMost})
                .size(),
            kFrameBytesMax);
}

TEST(Codec, RefusingASessionTakesLessThanTheMotionThatNamedIt) {
  Codec codec;
  ASSERT_TRUE(rc::check([&codec] {
    const MotionSample motion{any_count(), any_count(), any_time(), any_vector(1), any_server_law_numbers(), {}};
    const std::size_t question = codec.encode(motion).size();
    RC_ASSERT(codec.encode(Refusal{.session = motion.session, .reason = RefusalReason::unknown_session}).size() <
              question);
  }));
}

/// As many as an answer has room for, with every number set.
local_model::LocalModel most_models() {
  local_model::LocalModel most = test::sample_local_model();
  most.surfaces.fill(most.surfaces[0]);
  most.surface_count = local_model::LocalModel::kSurfacesMax;
  for (local_model::Surface& surface : most.surfaces) {
    surface.id = ~0U;
    surface.others_move_it = true;
  }
  most.mass.id = ~0U;
  most.mass.contacts[2] = most.mass.contacts[1];
  most.mass.contact_count = local_model::Mass::kContactsMax;
  most.mass.others_move_it = true;
  return most;
}

/// With vectors of so many rows, every number set.
EnvironmentForce longest_answer(const control::Vector& six) {
  return {.session = ~0ull,
          .sequence = ~0ull,
          .motion_sequence = ~0ull,
          .motion_device_time = -kTimeMost,
          .position = six,
          .server_receive_time = -kTimeMost,
          .server_send_time = -kTimeMost,
          .compute_time = -kTimeMost,
          .motions_received = ~0ull,
          .motions_duplicated = ~0ull,
          .motions_reordered = ~0ull,
          .server_law_numbers = server_law_numbers(16),
          .answer = {.force = six,
                     .torque_N_m = vector_of({1, 2, 3}),
                     .contact_normal = six,
                     .penetration_m = 1,
                     .texture_N = 1,
                     .texture_wave = six,
                     .texture_across = six,
                     .server_parts_N = six,
                     .texture_in_server_parts = true,
                     .model = most_models(),
                     .follower = control::FollowerState::taken}};
}

TEST(Codec, SaysTheMostThatAnyHalvesOfALawAndModelsCanSayInOneFrame) {
  Codec codec;
  const EnvironmentForce most = longest_answer(vector_of({1, 2, 3}));
  EXPECT_LE(codec.encode(most).size(), kFrameBytesMax);
  EXPECT_EQ(round_trip(codec, most).server_law_numbers, most.server_law_numbers);
  EXPECT_EQ(round_trip(codec, most).answer.model.surface_count, local_model::LocalModel::kSurfacesMax - 1);
  EXPECT_TRUE(round_trip(codec, most).answer.model.has_mass);
  EXPECT_TRUE(round_trip(codec, most).answer.model.has_field);
  EnvironmentForce without_a_mass = most;
  without_a_mass.answer.model.has_mass = false;
  EXPECT_EQ(round_trip(codec, without_a_mass).answer.model.surface_count, local_model::LocalModel::kSurfacesMax);
}

TEST(Codec, LeavesOutTheSurfacesThatDoNotFitBesideSixAxes) {
  Codec codec;
  const EnvironmentForce most = longest_answer(vector_of({1, 2, 3, 4, 5, 6}));
  EXPECT_LE(codec.encode(most).size(), kFrameBytesMax);
  const EnvironmentForce back = round_trip(codec, most);
  EXPECT_LT(back.answer.model.surface_count, local_model::LocalModel::kSurfacesMax);
  EXPECT_TRUE(back.answer.model.has_mass);
  EXPECT_TRUE(is_sound(back.answer.model));
  EXPECT_EQ(back.answer.force, most.answer.force);
  EXPECT_EQ(back.answer.torque_N_m, most.answer.torque_N_m);
}

TEST(Codec, CutsTextBetweenCharacters) {
  Codec codec;
  // One byte, then characters of two: byte 64 falls into the middle of one.
  std::string name = "x";
  while (name.size() < 2 * kNameBytesMax) name += "\xc3\xa4";
  const auto back = round_trip(codec, Hello{.device = name});
  EXPECT_EQ(back.device, name.substr(0, kNameBytesMax - 1));
}

}  // namespace
}  // namespace forcebound::wire
