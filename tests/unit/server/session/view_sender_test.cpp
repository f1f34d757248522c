#include "forcebound/server/session/view_sender.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "forcebound/view/assembly.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

using Json = nlohmann::json;

view::Assembly::Piece received(const wire::ViewPiece& piece) {
  return {.session = piece.session,
          .view = piece.view,
          .pieces = piece.pieces,
          .number = piece.number,
          .first = piece.first,
          .content = piece.content};
}

/// A client in space that asks how the scene looks, and moves at 1 kHz.
class ViewSenderTest : public ServerFixture {
 protected:
  std::uint64_t enter(const std::string& scene, bool shows, bool renders_locally = false) {
    wire::Hello hello{.client_nonce = ++nonce_, .degrees_of_freedom = 3, .device = "omni", .period_s = 1e-3};
    hello.scene = scene;
    hello.shows_scene = shows;
    hello.renders_locally = renders_locally;
    arrive(hello);
    const auto all = answers();
    return std::get<wire::Welcome>(all.at(0)).session;
  }

  /// Motions for so long, each at the same place; what came of pictures meanwhile goes to `assembly`.
  void move_for(std::uint64_t session, int ticks, const Vector& position_m = vector_of({0, 0, 0.2})) {
    for (int i = 0; i < ticks; ++i) {
      clock.time += milliseconds{1};
      wire::MotionSample motion = ServerFixture::motion(session, ++sequence_);
      motion.position = position_m;
      arrive(motion);
      for (const wire::Message& message : answers()) {
        const auto* const piece = std::get_if<wire::ViewPiece>(&message);
        if (piece == nullptr) continue;
        ++pieces;
        (void)assembly.add(received(*piece));
      }
    }
  }

  view::Assembly assembly;
  int pieces = 0;

 private:
  std::uint64_t nonce_ = 0;
  std::uint64_t sequence_ = 0;
};

TEST_F(ViewSenderTest, TellsNothingToWhoDoesNotAsk) {
  move_for(enter("sphere", false), 200);
  EXPECT_EQ(pieces, 0);
  EXPECT_EQ(server->counters().view_pieces_sent, 0U);
}

TEST_F(ViewSenderTest, TellsHowASceneLooksToWhoAsks) {
  move_for(enter("sphere", true), 200);
  ASSERT_TRUE(assembly.scene().has_value());
  const Json scene = Json::parse(view::scene_message(0, assembly.scene()->shown));
  EXPECT_EQ(scene["name"], "sphere");
  EXPECT_EQ(scene["shapes"].at(0)["kind"], "sphere");
  EXPECT_EQ(assembly.take_moved(0), "");
}

TEST_F(ViewSenderTest, TellsNothingOfWhatIsHandedOver) {
  move_for(enter("sphere", true, true), 200);
  ASSERT_TRUE(assembly.scene().has_value());
  EXPECT_TRUE(assembly.scene()->shown.empty());
}

TEST_F(ViewSenderTest, TellsWhereTissueIsAsItIsPressed) {
  const std::uint64_t session = enter("pad", true);
  move_for(session, 1500);
  ASSERT_TRUE(assembly.scene().has_value());
  const auto vertices = [this] { return Json::parse(assembly.take_moved(0))["meshes"].at(0)["vertices_m"]; };
  const Json at_rest = vertices();
  const Json scene = Json::parse(view::scene_message(0, assembly.scene()->shown));
  EXPECT_EQ(at_rest.size(), scene["meshes"].at(0)["vertices_m"].size());
  double top_m = 0;
  for (std::size_t i = 2; i < at_rest.size(); i += 3) top_m = std::max(top_m, at_rest[i].get<double>());
  for (int i = 0; i <= 20; ++i) move_for(session, 1, vector_of({0, 0, top_m + 0.01 - 0.0006 * i}));
  move_for(session, 500, vector_of({0, 0, top_m - 0.002}));
  const Json pressed = vertices();
  double deepest_m = 0;
  for (std::size_t i = 2; i < pressed.size(); i += 3) {
    deepest_m = std::max(deepest_m, at_rest[i].get<double>() - pressed[i].get<double>());
  }
  EXPECT_GT(deepest_m, 2e-4);
  EXPECT_LT(deepest_m, 0.01);
}

TEST_F(ViewSenderTest, KeepsItsRate) {
  start({.view = {.pieces_per_s = 20}});
  move_for(enter("pad", true), 4000);
  EXPECT_LE(pieces, 4 * 20 + 4);
  EXPECT_GE(pieces, 4 * 20 - 4);
}

TEST_F(ViewSenderTest, KeepsTheRateOfAllClientsTogether) {
  start({.view = {.pieces_per_s = 100, .pieces_per_s_all = 10}});
  move_for(enter("pad", true), 4000);
  EXPECT_LE(pieces, 4 * 10 + 100) << "after a burst";
}

TEST_F(ViewSenderTest, TellsNothingToAnAddressThatIsNotProven) {
  const std::uint64_t session = enter("sphere", true);
  for (std::uint64_t i = 1; i <= 300; ++i) {
    clock.time += milliseconds{1};
    wire::MotionSample motion = ServerFixture::motion(session, i);
    motion.position = vector_of({0, 0, 0.2});
    arrive(motion, address(static_cast<std::uint16_t>(2 + i % 2)));
  }
  for (const wire::Message& message : answers()) EXPECT_FALSE(std::holds_alternative<wire::ViewPiece>(message));
}

TEST_F(ViewSenderTest, DoesNotAllocateAsItTells) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const std::uint64_t session = enter("pad", true);
  link.keep = false;
  wire::MotionSample motion = ServerFixture::motion(session, 1);
  motion.position = vector_of({0, 0, 0.2});
  arrive(motion);
  const test::AllocationGuard guard;
  for (std::uint64_t i = 2; i < 300; ++i) {
    clock.time += milliseconds{1};
    motion.sequence = i;
    motion.device_time += milliseconds{1};
    arrive(motion);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(server->counters().view_pieces_sent, 20U);
}

}  // namespace
}  // namespace forcebound::server
