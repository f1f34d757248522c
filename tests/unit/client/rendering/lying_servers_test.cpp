#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "tests/support/meshes.hpp"
#include "tests/unit/client/rendering/stroked_loop.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::sim {
namespace {

/// Changes pieces of the scene on their way, with a checksum that agrees.
SimulatedNetwork::Tamper lie(std::function<void(wire::ScenePiece&, std::vector<std::byte>&)> change) {
  return [change = std::move(change), reader = std::make_shared<wire::Codec>(),
          writer = std::make_shared<wire::Codec>()](std::span<const std::byte> datagram, Nanoseconds) {
    const auto decoded = reader->decode(datagram);
    const auto* const message = std::get_if<wire::Message>(&decoded);
    if (message == nullptr || !std::holds_alternative<wire::ScenePiece>(*message)) return datagram;
    wire::ScenePiece piece = std::get<wire::ScenePiece>(*message);
    std::vector<std::byte> content(piece.content.begin(), piece.content.end());
    change(piece, content);
    piece.content = content;
    return writer->encode(piece);
  };
}

struct Lie {
  const char* name;
  void (*change)(wire::ScenePiece&, std::vector<std::byte>&);
};

class LyingServers : public ::testing::TestWithParam<Lie> {};

TEST_P(LyingServers, AreRefusedInOneLineAndTheirForcesHeld) {
  Watch watch;
  ClosedLoop loop(settings(handover::mesh_scene(test::ball(0.03, 30)), "delay 10ms", true,
                           "stroke:height_m=0.01,depth_m=0.004,offset_z_m=0.03"),
                  {&watch});
  loop.network().set_tamper(lie(GetParam().change));
  loop.run(4s);
  const json summary = summary_of(loop);
  EXPECT_EQ(summary["faults"]["scenes_refused"], 1);
  EXPECT_THAT(summary["faults"]["notes"].dump(), testing::HasSubstr("scene refused: "));
  EXPECT_EQ(watch.last.rendering, record::ForceOrigin::held);
  EXPECT_GT(summary["force_N"]["mean"], 0.1) << "forces are held instead";
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

constexpr Lie kLies[]{{"Manifest",
                       [](wire::ScenePiece& piece, std::vector<std::byte>& bytes) {
                         if (piece.number == 0) bytes[40] ^= std::byte{64};
                       }},
                      {"Geometry",
                       [](wire::ScenePiece& piece, std::vector<std::byte>& bytes) {
                         if (piece.number > 5) bytes[40] ^= std::byte{64};
                       }},
                      {"Number", [](wire::ScenePiece& piece, std::vector<std::byte>&) { piece.number += 100'000; }},
                      {"Length",
                       [](wire::ScenePiece& piece, std::vector<std::byte>& bytes) {
                         if (piece.number > 5) bytes.resize(1130);
                       }},
                      {"Order", [](wire::ScenePiece& piece, std::vector<std::byte>&) {
                         if (piece.number > 5) piece.number ^= 1;
                       }}};

INSTANTIATE_TEST_SUITE_P(LocalRendering, LyingServers, testing::ValuesIn(kLies),
                         [](const auto& lie) { return lie.param.name; });

/// Changes answers on their way, with a checksum that agrees.
SimulatedNetwork::Tamper answer_with(std::function<void(wire::EnvironmentForce&)> change) {
  return [change = std::move(change), reader = std::make_shared<wire::Codec>(),
          writer = std::make_shared<wire::Codec>()](std::span<const std::byte> datagram, Nanoseconds) {
    const auto decoded = reader->decode(datagram);
    const auto* const message = std::get_if<wire::Message>(&decoded);
    if (message == nullptr || !std::holds_alternative<wire::EnvironmentForce>(*message)) return datagram;
    wire::EnvironmentForce force = std::get<wire::EnvironmentForce>(*message);
    change(force);
    return writer->encode(force);
  };
}

TEST(LocalRendering, StaysPassiveWhenAModelPushesAwayFromItsPlaceEverHarder) {
  Watch watch;
  ClosedLoop loop(settings(handover::scene_of(kFrictionPlane), "delay 10ms", true), {&watch});
  loop.network().set_tamper(answer_with([](wire::EnvironmentForce& force) {
    force.answer.model.by_device_clock = true;
    force.answer.model.has_field = true;
    force.answer.model.field.place_m = scene::Point(force.position);
    force.answer.model.field.jacobian_N_per_m = 1e6 * Eigen::Matrix3d::Identity();
    force.answer.model.field.radius_m = 10;
  }));
  loop.run(3s);
  EXPECT_EQ(watch.last.model_trust, 0) << "it is given up";
  const json summary = summary_of(loop);
  EXPECT_EQ(summary["faults"]["models_refused"], 0) << "it can be";
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

TEST(LocalRendering, CountsUnsoundModelsAndHoldsTheirForces) {
  Watch watch;
  ClosedLoop loop(settings(handover::scene_of(kFrictionPlane), "delay 10ms", true), {&watch});
  loop.network().set_tamper(answer_with([](wire::EnvironmentForce& force) {
    force.answer.model.surfaces[0].stiffness_N_per_m = -1000 * Eigen::Matrix3d::Identity();
    force.answer.model.surfaces[0].radius_m = 1;
    force.answer.model.surface_count = 1;
  }));
  loop.run(1s);
  EXPECT_EQ(watch.last.model.rows(), 0);
  const json summary = summary_of(loop);
  EXPECT_GT(summary["faults"]["models_refused"], 500);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -1e-9);
}

TEST(LocalRendering, PassesOverPiecesOfAnotherSession) {
  Watch watch;
  ClosedLoop loop(settings(handover::scene_of(kFrictionPlane), "delay 10ms", true), {&watch});
  loop.network().set_tamper(lie([](wire::ScenePiece& piece, std::vector<std::byte>&) { piece.session ^= 1; }));
  loop.run(1s);
  EXPECT_EQ(watch.local, 0);
  EXPECT_EQ(loop.local()->pieces_received(), 0U);
  EXPECT_EQ(loop.local()->phase(), client::BuildPhase::wanting);
}

}  // namespace
}  // namespace forcebound::sim
