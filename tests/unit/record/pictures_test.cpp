#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "forcebound/record/mcap_reader.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "foxglove/geometry.pb.h"
#include "foxglove/scene.pb.h"
#include "tests/unit/record/sample_run.hpp"

// What a recording has for Foxglove's 3D panel.
namespace forcebound::record {
namespace {

using test::TemporaryFile;
using test::vector_of;

struct Pictures {
  std::vector<std::pair<std::uint64_t, foxglove::FrameTransform>> devices;
  std::vector<std::pair<std::uint64_t, foxglove::SceneUpdate>> arrows;
  std::vector<foxglove::SceneUpdate> scenes;
  std::map<std::string, std::string> schemas;  ///< by topic
};

Pictures pictures_in(const std::filesystem::path& file) {
  Pictures pictures;
  std::ifstream in(file, std::ios::binary);
  mcap::Visitor visitor;
  visitor.message = [&](const mcap::Schema& schema, const mcap::Channel& channel, const mcap::Message& message) {
    pictures.schemas[channel.topic] = schema.name;
    const std::string data(message.data);
    if (channel.topic == "/device") {
      EXPECT_TRUE(
          pictures.devices.emplace_back(message.log_time, foxglove::FrameTransform()).second.ParseFromString(data));
    } else if (channel.topic == "/arrows") {
      EXPECT_TRUE(pictures.arrows.emplace_back(message.log_time, foxglove::SceneUpdate()).second.ParseFromString(data));
    } else if (channel.topic == "/scene") {
      EXPECT_TRUE(pictures.scenes.emplace_back().ParseFromString(data));
    }
  };
  EXPECT_TRUE(mcap::read(in, file.string(), visitor).complete);
  return pictures;
}

const foxglove::SceneEntity* entity_of(const foxglove::SceneUpdate& update, const std::string& id) {
  for (const foxglove::SceneEntity& entity : update.entities()) {
    if (entity.id() == id) return &entity;
  }
  return nullptr;
}

TickRecord pictured_tick_at(std::int64_t ms) {
  TickRecord tick;
  tick.tick = static_cast<std::uint64_t>(ms) + 1;
  tick.time = std::chrono::milliseconds{ms};
  tick.position = vector_of({0.01, -0.02, 0.03});
  tick.applied = vector_of({0, 0, 2});
  tick.request = vector_of({0, 3, 0});
  tick.remote = vector_of({0, 0, 0});
  return tick;
}

TEST(Pictures, ComeSixtyTimesASecondWhateverTheRateOfTheTicks) {
  const TemporaryFile file("rate.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  for (std::int64_t ms = 0; ms < 5000; ++ms) writer.write(pictured_tick_at(ms));
  writer.finish({});
  const Pictures pictures = pictures_in(file.path());
  EXPECT_EQ(pictures.devices.size(), 300U);
  EXPECT_EQ(pictures.arrows.size(), 300U);
  EXPECT_EQ(pictures.schemas.at("/device"), "foxglove.FrameTransform");
  EXPECT_EQ(pictures.schemas.at("/arrows"), "foxglove.SceneUpdate");
  EXPECT_EQ(pictures.schemas.at("/tick"), "forcebound.v1.TickRecord");
}

TEST(Pictures, ShowTheTipAndTheForcesOnIt) {
  const TemporaryFile file("arrows.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  TickRecord tick = pictured_tick_at(0);
  tick.handle.orientation = {{0, 0, 0, 1}};
  writer.write(tick);
  writer.finish({});
  const Pictures pictures = pictures_in(file.path());
  ASSERT_EQ(pictures.devices.size(), 1U);
  const auto& [logged, device] = pictures.devices[0];
  EXPECT_EQ(logged, 1'700'000'000'000'000'000U);
  EXPECT_EQ(device.timestamp().seconds(), 1'700'000'000);
  EXPECT_EQ(device.parent_frame_id(), "scene");
  EXPECT_EQ(device.child_frame_id(), "device");
  EXPECT_EQ(device.translation().y(), -0.02);
  EXPECT_EQ(device.rotation().z(), 1);

  ASSERT_EQ(pictures.arrows.size(), 1U);
  const foxglove::SceneUpdate& update = pictures.arrows[0].second;
  const auto* displayed = entity_of(update, "device: displayed force");
  ASSERT_NE(displayed, nullptr);
  EXPECT_EQ(displayed->frame_id(), "scene");
  EXPECT_EQ(displayed->lifetime().nanos(), 250'000'000);
  ASSERT_EQ(displayed->arrows_size(), 1);
  const foxglove::ArrowPrimitive& arrow = displayed->arrows(0);
  EXPECT_DOUBLE_EQ(arrow.shaft_length() + arrow.head_length(), 0.02);  // 2 N
  EXPECT_EQ(arrow.pose().position().z(), 0.03);
  const auto& turn = arrow.pose().orientation();
  const Eigen::Vector3d along = Eigen::Quaterniond(turn.w(), turn.x(), turn.y(), turn.z()) * Eigen::Vector3d::UnitX();
  EXPECT_LT((along - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_EQ(entity_of(update, "device: requested force")->arrows_size(), 1);
  EXPECT_EQ(entity_of(update, "device: remote force")->arrows_size(), 0);  // no force, no arrow
  EXPECT_EQ(entity_of(update, "device")->spheres_size(), 1);
}

TEST(Pictures, OfNumbersThatAreNotFiniteAreFinite) {
  const TemporaryFile file("finite.mcap");
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  RecordingWriter writer(file.path(), test::sample_info());
  TickRecord tick = pictured_tick_at(0);
  tick.position = vector_of({kNaN, 1, std::numeric_limits<double>::infinity()});
  tick.applied = vector_of({kNaN, 0, 1});
  tick.handle.orientation = {{kNaN, 0, 0, 0}};
  writer.write(tick);
  writer.finish({});
  const Pictures pictures = pictures_in(file.path());
  ASSERT_EQ(pictures.devices.size(), 1U);
  EXPECT_EQ(pictures.devices[0].second.translation().x(), 0);
  EXPECT_EQ(pictures.devices[0].second.translation().z(), 0);
  EXPECT_EQ(pictures.devices[0].second.rotation().w(), 1);
  EXPECT_EQ(entity_of(pictures.arrows[0].second, "device: displayed force")->arrows_size(), 0);
}

TEST(Pictures, OfAServerHaveADeviceForEachSession) {
  const TemporaryFile file("sessions.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  for (std::int64_t ms = 0; ms < 100; ++ms) {
    for (const std::uint64_t session : {77U, 99U}) {
      wire::MotionSample motion{.session = session, .sequence = static_cast<std::uint64_t>(ms) + 1};
      motion.position = vector_of({static_cast<double>(session), 0, 0});
      writer.write(MotionRecord{std::chrono::milliseconds{ms}, motion});
      SentForceRecord force;
      force.force.session = session;
      force.force.answer.force = vector_of({0, 0, 1});
      force.force.server_send_time = std::chrono::milliseconds{ms};
      writer.write(force);
    }
  }
  writer.finish({});
  const Pictures pictures = pictures_in(file.path());
  std::map<std::string, int> devices;
  for (const auto& [logged, device] : pictures.devices) {
    ++devices[device.child_frame_id()];
    EXPECT_EQ(device.translation().x(), device.child_frame_id() == "server's device 1" ? 77 : 99);
  }
  EXPECT_EQ(devices, (std::map<std::string, int>{{"server's device 1", 6}, {"server's device 2", 6}}));
  EXPECT_EQ(pictures.arrows.size(), 12U);
}

TEST(Pictures, OfASceneReplaceTheOneBefore) {
  const TemporaryFile file("scene.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  using Kind = ScenePart::Kind;
  ScenePart plane{.name = "floor", .kind = Kind::plane};
  ScenePart capsule{.name = "rod", .kind = Kind::capsule, .place_m = {0, 0, 1}, .size_m = {0.1, 0.1, 0.5}};
  ScenePart mesh{.name = "mesh", .vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}, {0, 1, 3}}};
  ScenePart box{.name = "box", .kind = Kind::box, .size_m = {0.1, 0.2, std::numeric_limits<double>::infinity()}};
  writer.write_scene(std::vector{plane, capsule, mesh, box}, Nanoseconds{5});
  writer.write_scene({}, Nanoseconds{6});
  writer.finish({});
  const Pictures pictures = pictures_in(file.path());
  ASSERT_EQ(pictures.scenes.size(), 2U);
  const foxglove::SceneUpdate& first = pictures.scenes[0];
  ASSERT_EQ(first.deletions_size(), 1);
  EXPECT_EQ(first.deletions(0).type(), foxglove::SceneEntityDeletion::ALL);
  ASSERT_EQ(first.entities_size(), 4);
  EXPECT_EQ(first.entities(0).id(), "1 floor");
  const foxglove::CubePrimitive& floor = first.entities(0).cubes(0);
  EXPECT_DOUBLE_EQ(floor.pose().position().z() + 0.5 * floor.size().z(), 0);  // its upper side is the plane
  const foxglove::SceneEntity& rod = first.entities(1);
  EXPECT_EQ(rod.cylinders(0).size().z(), 0.5);
  ASSERT_EQ(rod.spheres_size(), 2);
  EXPECT_EQ(rod.spheres(0).pose().position().z(), 1.25);
  EXPECT_EQ(rod.spheres(1).pose().position().z(), 0.75);
  EXPECT_EQ(first.entities(2).triangles(0).points_size(), 3);
  EXPECT_EQ(first.entities(2).triangles(0).indices_size(), 3);  // without the corner that there is not
  EXPECT_TRUE(std::isfinite(first.entities(3).cubes(0).size().z()));
  EXPECT_EQ(pictures.scenes[1].entities_size(), 0);
}

TEST(Pictures, OfAServerShow256SessionsAndOthersOnceSomeHaveEnded) {
  const TemporaryFile file("sessions.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  const auto move = [&](std::uint64_t session, Nanoseconds at) {
    MotionRecord motion;
    motion.motion.session = session;
    motion.motion.position = vector_of({0, 0, 0});
    motion.receive_time = at;
    writer.write(motion);
  };
  for (int second = 0; second < 3; ++second) {
    for (std::uint64_t session = 1; session <= 300; ++session) move(session, std::chrono::seconds(second));
  }
  for (std::uint64_t session = 1001; session <= 1010; ++session) move(session, std::chrono::seconds(30));
  writer.finish({});
  std::set<std::string> devices;
  const Pictures pictures = pictures_in(file.path());
  for (const auto& [time, device] : pictures.devices) devices.insert(device.child_frame_id());
  EXPECT_EQ(devices.size(), 256U + 10U);
  EXPECT_EQ(pictures.devices.size(), 3U * 256U + 10U);
}

TEST(Pictures, AreNoRecordsToOurReader) {
  struct Nothing final : RecordingSink {
    void on_start(const RunInfo&) override {}
    void on_end(const RunTotals&) override {}
    void on_tick(const TickRecord&) noexcept override { ++records; }
    void on_force(const ForceRecord&) noexcept override { ++records; }
    void on_file(const RecordedFile& file) override { files += file.name + "|" + file.media_type + "|" + file.content; }
    int records = 0;
    std::string files;
  } sink;
  const TemporaryFile file("files.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  writer.write_scene({}, Nanoseconds{5});
  writer.write(pictured_tick_at(0));
  writer.attach({.name = "device.toml", .media_type = "application/toml", .content = "mass_kg = 1\n"}, Nanoseconds{6});
  writer.finish({});
  EXPECT_TRUE(read_recording(file.path(), sink));
  EXPECT_EQ(sink.records, 1);
  EXPECT_EQ(sink.files, "device.toml|application/toml|mass_kg = 1\n");
}

}  // namespace
}  // namespace forcebound::record
