#pragma once

#include <zlib.h>

#include <array>
#include <cstddef>
#include <vector>

#include "forcebound/wire/codec.hpp"
#include "tests/support/sample_local_model.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::wire {

using test::vector_of;

inline control::ServerLawNumbers server_law_numbers(int count, double first = 0.5) {
  return control::ServerLawNumbers::LinSpaced(count, first, first + count - 1);
}

inline constexpr std::array kPieceContent{std::byte{1}, std::byte{0}, std::byte{255}};

using Bytes = std::vector<std::byte>;

/// A valid frame around any bytes, as an attacker can make it.
inline Bytes framed(unsigned kind, const Bytes& body) {
  Bytes bytes{std::byte{'F'}, std::byte{'B'}, std::byte{1}, std::byte(kind)};
  Bytes covered{std::byte(kind)};
  covered.insert(covered.end(), body.begin(), body.end());
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(covered.data()), static_cast<uInt>(covered.size()));
  for (int i = 0; i < 4; ++i) bytes.push_back(std::byte(sum >> (8 * i) & 0xff));
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

/// Every field set.
inline EnvironmentForce sample_force() {
  return {.session = 0xfedcba9876543210,
          .sequence = 999,
          .motion_sequence = 1000,
          .motion_device_time = Nanoseconds{123456789},
          .position = vector_of({0.01, -0.02, 0.03}),
          .server_receive_time = Nanoseconds{-5},
          .server_send_time = Nanoseconds{7},
          .compute_time = Nanoseconds{300},
          .motions_received = 990,
          .motions_duplicated = 3,
          .motions_reordered = 2,
          .server_law_numbers = server_law_numbers(16, -3),
          .answer = {.force = vector_of({1, 2, -3}),
                     .torque_N_m = vector_of({0.1, -0.2, 0.3}),
                     .contact_normal = vector_of({0, 0, 1}),
                     .penetration_m = 0.002,
                     .texture_N = 0.4,
                     .texture_wave = vector_of({3000, 0, 0}),
                     .texture_across = vector_of({0, 3000, 0}),
                     .server_parts_N = vector_of({0, 1, 0}),
                     .texture_in_server_parts = true,
                     .model = test::sample_local_model()}};
}

/// One of each kind, every field set.
inline std::array<Message, 8> one_of_each() {
  return {Hello{.protocol_version = 2,
                .client_nonce = 0x0123456789abcdef,
                .degrees_of_freedom = 3,
                .device = "omni",
                .period_s = 1e-3,
                .force_N_max = 3.3,
                .scene = "sphere",
                .client_time = Nanoseconds{-12},
                .round_trip = Nanoseconds{20000000},
                .server_law = "wave",
                .renders_locally = true,
                .shows_scene = true,
                .shows_torque = true},
          Welcome{.client_nonce = 0x0123456789abcdef,
                  .session = 0xfedcba9876543210,
                  .scene_hash = 77,
                  .scene = "sphere",
                  .simulated = "ball: surface",
                  .offer = {.manifest_sha256 = {std::byte{7}, std::byte{9}}, .manifest_bytes = 900, .pieces = 30},
                  .server_parts = ServerParts::modelled,
                  .tool_m = vector_of({0, 0.01, -0.1})},
          Refusal{.client_nonce = 0x0123456789abcdef,
                  .session = 5,
                  .reason = RefusalReason::unknown_scene,
                  .text = "no scene 'spere'",
                  .client_time = Nanoseconds{-12},
                  .protocol_version = 2},
          MotionSample{.session = 0xfedcba9876543210,
                       .sequence = 1000,
                       .device_time = Nanoseconds{123456789},
                       .position = vector_of({0.01, -0.02, 0.03}),
                       .server_law_numbers = server_law_numbers(16),
                       .pieces = {.wanted = true, .newest = 70, .before = 0xfedcba9876543210},
                       .challenge = 0x123456789abcdef0,
                       .handle = {.buttons = 0x80000001, .gripper = 0.25, .orientation = {{0.5, -0.5, 0.5, -0.5}}}},
          sample_force(),
          Bye{.session = 0xfedcba9876543210,
              .motions_received = 990,
              .motions_duplicated = 3,
              .motions_reordered = 2,
              .forces_sent = 988,
              .motions_behind = 40},
          ScenePiece{.session = 0xfedcba9876543210, .transmission = 80, .number = 12, .content = kPieceContent},
          ViewPiece{.session = 0xfedcba9876543210,
                    .view = 0x0f1e2d3c4b5a6978,
                    .pieces = 40,
                    .number = 39,
                    .first = 270,
                    .content = kPieceContent}};
}

}  // namespace forcebound::wire
