#include "forcebound/wire/codec.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <limits>
#include <tuple>
#include <vector>

#include "tests/support/special_numbers.hpp"
#include "tests/unit/wire/any_message.hpp"

namespace forcebound::wire {
namespace {

template <class Rows>
void expect_same(const Rows& a, const Rows& b) {
  RC_ASSERT(a.rows() == b.rows());
  RC_ASSERT((a.array() == b.array()).all());
}

TEST(Codec, WhatAHandleHasNotTakesNoBytes) {
  Codec codec;
  MotionSample motion{.session = 1, .sequence = 1, .position = vector_of({0.25, -2})};
  const std::size_t without = codec.encode(motion).size();
  motion.handle.buttons = 0;
  EXPECT_EQ(codec.encode(motion).size(), without + 2) << "none pressed is not none there";
  EXPECT_EQ(round_trip(codec, motion).handle, control::Handle{.buttons = 0});
  motion.handle.gripper = 0;
  EXPECT_EQ(codec.encode(motion).size(), without + 7);
  motion.handle.orientation = {{1, 0, 0, 0}};
  EXPECT_EQ(codec.encode(motion).size(), without + 25);
  motion.handle = {};
  EXPECT_EQ(codec.encode(motion).size(), without);
}

TEST(Codec, AMotionWhoseHandleIsNotFiniteIsRefused) {
  Codec codec;
  MotionSample motion{.session = 1, .sequence = 1, .position = vector_of({0}), .handle = {.gripper = test::kNaN}};
  EXPECT_EQ(std::get<Malformed>(codec.decode(codec.encode(motion))), Malformed::non_finite);
  motion.handle = control::Handle{.orientation = {{1, test::kInfinity, 0, 0}}};
  EXPECT_EQ(std::get<Malformed>(codec.decode(codec.encode(motion))), Malformed::non_finite);
}

TEST(Codec, AnOrientationThatHasNotFourNumbersIsNone) {
  Codec codec;
  Bytes body{std::byte{0x22}, std::byte{8}};  // one position, zero
  body.insert(body.end(), 8, std::byte{0});
  const auto with = [&](std::size_t numbers) {
    Bytes longer = body;
    longer.push_back(std::byte{0x62});
    longer.push_back(std::byte(4 * numbers));
    for (std::size_t i = 0; i < numbers; ++i)
      longer.insert(longer.end(), {std::byte{0}, std::byte{0}, std::byte{0x80}, std::byte{0x3f}});
    return std::get<MotionSample>(std::get<Message>(codec.decode(framed(4, longer)))).handle;
  };
  EXPECT_EQ(with(4).orientation, (control::Handle::Orientation{1, 1, 1, 1})) << "as it came";
  for (const std::size_t numbers : {1U, 3U, 5U, 20U}) EXPECT_EQ(with(numbers), control::Handle{}) << numbers;
}

TEST(Codec, GivesHelloBack) {
  Codec codec;
  const auto back = round_trip(codec, std::get<Hello>(one_of_each()[0]));
  EXPECT_EQ(back.protocol_version, 2u);
  EXPECT_EQ(back.client_nonce, 0x0123456789abcdefu);
  EXPECT_EQ(back.degrees_of_freedom, 3u);
  EXPECT_EQ(back.device, "omni");
  EXPECT_EQ(back.period_s, 1e-3);
  EXPECT_EQ(back.force_N_max, 3.3);
  EXPECT_EQ(back.scene, "sphere");
  EXPECT_EQ(back.client_time, Nanoseconds{-12});
  EXPECT_EQ(back.round_trip, Nanoseconds{20000000});
  EXPECT_EQ(back.server_law, "wave");
  EXPECT_TRUE(back.renders_locally);
}

TEST(Codec, GivesWelcomeBack) {
  Codec codec;
  const auto back = round_trip(codec, std::get<Welcome>(one_of_each()[1]));
  EXPECT_EQ(back.client_nonce, 0x0123456789abcdefu);
  EXPECT_EQ(back.session, 0xfedcba9876543210u);
  EXPECT_EQ(back.scene_hash, 77u);
  EXPECT_EQ(back.scene, "sphere");
  EXPECT_EQ(back.simulated, "ball: surface");
  EXPECT_EQ(back.offer.manifest_sha256[1], std::byte{9});
  EXPECT_EQ(back.offer.manifest_bytes, 900U);
  EXPECT_EQ(back.offer.pieces, 30U);
  EXPECT_EQ(back.server_parts, ServerParts::modelled);
}

TEST(Codec, GivesAPieceOfAPictureBackInADatagramAtMost) {
  Codec codec;
  const auto piece = round_trip(codec, std::get<ViewPiece>(one_of_each()[7]));
  EXPECT_EQ(piece.session, 0xfedcba9876543210U);
  EXPECT_EQ(piece.view, 0x0f1e2d3c4b5a6978U);
  EXPECT_EQ(piece.pieces, 40U);
  EXPECT_EQ(piece.number, 39U);
  EXPECT_EQ(piece.first, 270U);
  EXPECT_TRUE(std::ranges::equal(piece.content, kPieceContent));
  const std::vector<std::byte> longest(1100, std::byte{0xff});
  EXPECT_LE(codec
                .encode(ViewPiece{
                    .session = ~0ull, .view = ~0ull, .pieces = ~0u, .number = ~0u, .first = ~0u, .content = longest})
                .size(),
            kFrameBytesMax);
}

TEST(Codec, GivesAPieceOfASceneAndItsReceiptBack) {
  Codec codec;
  const auto piece = round_trip(codec, std::get<ScenePiece>(one_of_each()[6]));
  EXPECT_EQ(piece.session, 0xfedcba9876543210U);
  EXPECT_EQ(piece.transmission, 80U);
  EXPECT_EQ(piece.number, 12U);
  EXPECT_TRUE(std::ranges::equal(piece.content, kPieceContent));
  EXPECT_EQ(round_trip(codec, std::get<MotionSample>(one_of_each()[3])).pieces,
            (PieceReceipt{.wanted = true, .newest = 70, .before = 0xfedcba9876543210}));
  EXPECT_EQ(round_trip(codec, std::get<MotionSample>(one_of_each()[3])).handle,
            (control::Handle{.buttons = 0x80000001, .gripper = 0.25, .orientation = {{0.5, -0.5, 0.5, -0.5}}}));
  const auto force = round_trip(codec, std::get<EnvironmentForce>(one_of_each()[4]));
  EXPECT_EQ(force.answer.server_parts_N, vector_of({0, 1, 0}));
  EXPECT_TRUE(force.answer.texture_in_server_parts);
}

TEST(Codec, GivesATorqueAndAToolBackAndTakesThemForAbsentWhereTheyAre) {
  Codec codec;
  EXPECT_TRUE(round_trip(codec, std::get<Hello>(one_of_each()[0])).shows_torque);
  EXPECT_FALSE(round_trip(codec, Hello{}).shows_torque);
  EXPECT_EQ(round_trip(codec, std::get<Welcome>(one_of_each()[1])).tool_m, vector_of({0, 0.01, -0.1}));
  EXPECT_EQ(round_trip(codec, Welcome{}).tool_m.rows(), 0);
  const auto told = codec.encode(Welcome{.tool_m = vector_of({0, 0, -0.6})});
  EXPECT_EQ(std::get<Malformed>(codec.decode(told)), Malformed::unreadable) << "longer than any that is held";
  EXPECT_EQ(round_trip(codec, std::get<EnvironmentForce>(one_of_each()[4])).answer.torque_N_m,
            vector_of({0.1, -0.2, 0.3}));
  EXPECT_EQ(round_trip(codec, EnvironmentForce{}).answer.torque_N_m.rows(), 0);
}

void expect_same(const local_model::Body& body, const local_model::Body& was) {
  EXPECT_EQ(body.velocity_m_per_s, was.velocity_m_per_s);
  EXPECT_EQ(body.bias_m_per_s2, was.bias_m_per_s2);
  EXPECT_EQ(body.mobility_per_kg, was.mobility_per_kg);
  EXPECT_EQ(std::tie(body.spring_N_per_m, body.damper_N_s_per_m, body.dry_friction_N),
            std::tie(was.spring_N_per_m, was.damper_N_s_per_m, was.dry_friction_N));
}

TEST(Codec, GivesLocalModelsBackBitForBitWhereTheirNumbersHave24Bits) {
  Codec codec;
  const local_model::LocalModel sent = std::get<EnvironmentForce>(one_of_each()[4]).answer.model;
  const local_model::LocalModel back = round_trip(codec, std::get<EnvironmentForce>(one_of_each()[4])).answer.model;
  EXPECT_TRUE(local_model::is_sound(back));
  EXPECT_EQ(back.by_device_clock, sent.by_device_clock);
  EXPECT_EQ(back.before_reading, sent.before_reading);
  ASSERT_EQ(back.surface_count, 1U);
  const local_model::Surface& surface = back.surfaces[0];
  EXPECT_EQ(surface.id, sent.surfaces[0].id);
  EXPECT_EQ(surface.force_N, sent.surfaces[0].force_N);
  EXPECT_EQ(surface.place_m, sent.surfaces[0].place_m);
  EXPECT_EQ(surface.normal, sent.surfaces[0].normal);
  EXPECT_EQ(surface.stiffness_N_per_m, sent.surfaces[0].stiffness_N_per_m);
  EXPECT_EQ(surface.damping_N_s_per_m, sent.surfaces[0].damping_N_s_per_m);
  EXPECT_EQ(surface.velocity_m_per_s, sent.surfaces[0].velocity_m_per_s);
  EXPECT_EQ(surface.acceleration_m_per_s2, sent.surfaces[0].acceleration_m_per_s2);
  EXPECT_EQ(surface.relaxing_N_per_m, sent.surfaces[0].relaxing_N_per_m);
  EXPECT_EQ(surface.relaxation_s, sent.surfaces[0].relaxation_s);
  EXPECT_EQ(surface.relaxed_N, sent.surfaces[0].relaxed_N);
  EXPECT_EQ(surface.friction, sent.surfaces[0].friction);
  EXPECT_EQ(surface.radius_m, sent.surfaces[0].radius_m);
  EXPECT_TRUE(surface.others_move_it);
  ASSERT_TRUE(back.has_mass);
  EXPECT_EQ(back.mass.id, sent.mass.id);
  EXPECT_EQ(back.mass.force_N, sent.mass.force_N);
  EXPECT_EQ(back.mass.place_m, sent.mass.place_m);
  EXPECT_EQ(back.mass.stiffness_N_per_m, sent.mass.stiffness_N_per_m);
  EXPECT_EQ(back.mass.damping_N_s_per_m, sent.mass.damping_N_s_per_m);
  expect_same(back.mass.body, sent.mass.body);
  ASSERT_EQ(back.mass.contact_count, sent.mass.contact_count);
  for (std::size_t i = 0; i < sent.mass.contact_count; ++i) {
    const local_model::Contact& contact = back.mass.contacts.at(i);
    const local_model::Contact& was = sent.mass.contacts.at(i);
    EXPECT_EQ(contact.normal, was.normal);
    EXPECT_EQ(std::tie(contact.gap_m, contact.compliance_per_kg, contact.stiffness_per_s2, contact.damping_per_s,
                       contact.friction, contact.radius_m, contact.travel_m, contact.return_m),
              std::tie(was.gap_m, was.compliance_per_kg, was.stiffness_per_s2, was.damping_per_s, was.friction,
                       was.radius_m, was.travel_m, was.return_m));
    expect_same(contact.met, was.met);
  }
  EXPECT_EQ(back.mass.radius_m, sent.mass.radius_m);
  EXPECT_TRUE(back.mass.others_move_it);
  ASSERT_TRUE(back.has_field);
  EXPECT_EQ(back.field.force_N, sent.field.force_N);
  EXPECT_EQ(back.field.place_m, sent.field.place_m);
  EXPECT_EQ(back.field.jacobian_N_per_m, sent.field.jacobian_N_per_m);
  EXPECT_EQ(back.field.radius_m, sent.field.radius_m);
}

TEST(Codec, TakesWhatIsNotSaidToBeMovedByOthersForTheDevicesOwn) {
  Codec codec;
  EnvironmentForce sent = std::get<EnvironmentForce>(one_of_each()[4]);
  sent.answer.model.surfaces[0].others_move_it = sent.answer.model.mass.others_move_it = false;
  const local_model::LocalModel back = round_trip(codec, sent).answer.model;
  EXPECT_FALSE(back.surfaces[0].others_move_it);
  EXPECT_FALSE(back.mass.others_move_it);
}

TEST(Codec, GivesAModelThatIsNotFiniteAsItIsWithAForceThatCanBeHeld) {
  Codec codec;
  EnvironmentForce sent = std::get<EnvironmentForce>(one_of_each()[4]);
  sent.answer.model.surfaces[0].place_m[1] = std::numeric_limits<double>::quiet_NaN();
  const EnvironmentForce back = round_trip(codec, sent);
  EXPECT_EQ(back.answer.force, sent.answer.force);
  EXPECT_FALSE(back.answer.model.empty());
  EXPECT_FALSE(local_model::is_sound(back.answer.model));
}

TEST(Codec, SaysTheLongestPieceInOneFrame) {
  Codec codec;
  const std::vector<std::byte> longest(1100);
  EXPECT_LE(codec.encode(ScenePiece{.session = ~0ull, .transmission = ~0ull, .number = ~0u, .content = longest}).size(),
            kFrameBytesMax);
}

TEST(Codec, GivesEveryRefusalBack) {
  Codec codec;
  for (const auto reason :
       {RefusalReason::unspecified, RefusalReason::version_mismatch, RefusalReason::unknown_scene,
        RefusalReason::wrong_degrees_of_freedom, RefusalReason::server_full, RefusalReason::unknown_session,
        RefusalReason::round_trip_wanted, RefusalReason::unknown_server_law, RefusalReason::encryption_wanted}) {
    const auto back = round_trip(
        codec,
        Refusal{.client_nonce = 1, .session = 2, .reason = reason, .text = "why", .client_time = Nanoseconds{-12}});
    EXPECT_EQ(back.client_nonce, 1u);
    EXPECT_EQ(back.session, 2u);
    EXPECT_EQ(back.reason, reason);
    EXPECT_EQ(back.text, "why");
    EXPECT_EQ(back.client_time, Nanoseconds{-12});
  }
}

TEST(Codec, GivesAnyMotionBackBitForBit) {
  Codec codec;
  ASSERT_TRUE(rc::check([&codec] {
    MotionSample sent{any_count(), any_count(), any_time(), any_vector(1), any_server_law_numbers(), {}};
    sent.energy_given_J = *finite_number();
    const MotionSample back = round_trip(codec, sent);
    RC_ASSERT(back.session == sent.session);
    RC_ASSERT(back.sequence == sent.sequence);
    RC_ASSERT(back.device_time == sent.device_time);
    expect_same(back.position, sent.position);
    expect_same(back.server_law_numbers, sent.server_law_numbers);
    RC_ASSERT(back.energy_given_J == sent.energy_given_J);
  }));
}

TEST(Codec, AnUnknownStateOfARobotIsFailed) {
  Codec codec;
  Bytes body{std::byte{0xf0}, std::byte{1}};  // follower_state
  for (const auto& [number, state] :
       {std::pair{0U, control::FollowerState::none}, std::pair{2U, control::FollowerState::following},
        std::pair{8U, control::FollowerState::taken}, std::pair{9U, control::FollowerState::failed},
        std::pair{100U, control::FollowerState::failed}}) {
    Bytes with = body;
    with.push_back(std::byte(number));
    EXPECT_EQ(std::get<EnvironmentForce>(std::get<Message>(codec.decode(framed(5, with)))).answer.follower, state)
        << number;
  }
}

TEST(Codec, GivesAnyForceBackBitForBit) {
  Codec codec;
  ASSERT_TRUE(rc::check([&codec] {
    const EnvironmentForce sent{
        .session = any_count(),
        .sequence = any_count(),
        .motion_sequence = any_count(),
        .motion_device_time = any_time(),
        .position = any_vector(0),
        .server_receive_time = any_time(),
        .server_send_time = any_time(),
        .compute_time = any_time(),
        .motions_received = any_count(),
        .motions_duplicated = any_count(),
        .motions_reordered = any_count(),
        .server_law_numbers = any_server_law_numbers(),
        .answer = {.force = any_vector(0),
                   .torque_N_m = any_vector(0),
                   .contact_normal = any_vector(0),
                   .penetration_m = *finite_number(),
                   .texture_N = *finite_number(),
                   .texture_wave = any_vector(0),
                   .texture_across = any_vector(0),
                   .server_parts_N = any_vector(0),
                   .texture_in_server_parts = *rc::gen::arbitrary<bool>(),
                   .model = {},
                   .follower = control::follower_state_of(*rc::gen::inRange(0U, unsigned{control::kFollowerStates}))}};
    const EnvironmentForce back = round_trip(codec, sent);
    RC_ASSERT(back.session == sent.session);
    RC_ASSERT(back.sequence == sent.sequence);
    RC_ASSERT(back.motion_sequence == sent.motion_sequence);
    RC_ASSERT(back.motion_device_time == sent.motion_device_time);
    expect_same(back.answer.force, sent.answer.force);
    expect_same(back.answer.torque_N_m, sent.answer.torque_N_m);
    expect_same(back.position, sent.position);
    expect_same(back.answer.contact_normal, sent.answer.contact_normal);
    RC_ASSERT(back.answer.texture_N == sent.answer.texture_N);
    expect_same(back.answer.texture_wave, sent.answer.texture_wave);
    expect_same(back.answer.texture_across, sent.answer.texture_across);
    expect_same(back.server_law_numbers, sent.server_law_numbers);
    expect_same(back.answer.server_parts_N, sent.answer.server_parts_N);
    RC_ASSERT(back.answer.texture_in_server_parts == sent.answer.texture_in_server_parts);
    RC_ASSERT(back.answer.follower == sent.answer.follower);
    RC_ASSERT(back.answer.penetration_m == sent.answer.penetration_m);
    RC_ASSERT(back.server_receive_time == sent.server_receive_time);
    RC_ASSERT(back.server_send_time == sent.server_send_time);
    RC_ASSERT(back.compute_time == sent.compute_time);
    RC_ASSERT(back.motions_received == sent.motions_received);
    RC_ASSERT(back.motions_duplicated == sent.motions_duplicated);
    RC_ASSERT(back.motions_reordered == sent.motions_reordered);
  }));
}

TEST(Codec, GivesAnyByeBack) {
  Codec codec;
  ASSERT_TRUE(rc::check([&codec] {
    const Bye sent{any_count(), any_count(), any_count(), any_count(), any_count(), any_count()};
    const Bye back = round_trip(codec, sent);
    RC_ASSERT(back.session == sent.session);
    RC_ASSERT(back.motions_received == sent.motions_received);
    RC_ASSERT(back.motions_duplicated == sent.motions_duplicated);
    RC_ASSERT(back.motions_reordered == sent.motions_reordered);
    RC_ASSERT(back.forces_sent == sent.forces_sent);
    RC_ASSERT(back.motions_behind == sent.motions_behind);
  }));
}

}  // namespace
}  // namespace forcebound::wire
