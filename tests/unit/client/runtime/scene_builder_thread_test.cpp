#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <thread>

#include "forcebound/client/rendering/local_rendering.hpp"
#include "forcebound/handover/packed_scene.hpp"
#include "forcebound/scene/part.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<const handover::PackedScene> packed_floor() {
  const scene::PartDescription floor{
      .name = "floor",
      .shape =
          scene::NamedValues{"half_space", {{"through_m", scene::Point(0, 0, 0)}, {"normal", scene::Point(0, 0, 1)}}},
      .effects = {{"surface", {{"stiffness_N_per_m", 1000.0}}}}};
  scene::SceneParts parts;
  parts.objects.push_back(scene::make_part(floor, scene::Registry::standard(), 3));
  return handover::pack(scene::Scene({.name = "floor", .description = ""}, std::move(parts)));
}

//   this thread: offers a scene again and again, reads counts and reasons --> builder on a thread of its own
//
// ThreadSanitizer sees whether both touch the same memory.
TEST(SceneBuilder, IsReadWhileItWorksOnAnotherThread) {
  const auto scene = packed_floor();
  const handover::Announcement& announced = scene->announcement();
  LocalRendering local({.degrees_of_freedom = 3});
  const std::jthread building([&builder = local.builder()](const std::stop_token& ended) {
    while (!ended.stop_requested()) {
      builder.work(ended);
      std::this_thread::yield();
    }
  });
  wire::SceneOffer offer{.manifest_sha256 = announced.hash,
                         .manifest_bytes = static_cast<std::uint32_t>(announced.manifest_bytes),
                         .pieces = static_cast<std::uint32_t>(announced.pieces)};
  const auto patient_until = std::chrono::steady_clock::now() + 60s;
  const auto wait_for = [&](BuildPhase phase) {
    while (local.phase() != phase && std::chrono::steady_clock::now() < patient_until) {
      (void)local.builder().counts();
      (void)local.answer(Vector::Zero(3), 0ns, std::nullopt);
      std::this_thread::yield();
    }
    ASSERT_EQ(local.phase(), phase);
  };
  constexpr std::uint64_t kSessions = 20;
  for (std::uint64_t session = 1; session <= kSessions; ++session) {
    // Every other one lies about its hash.
    const bool honest = session % 2 == 0;
    offer.manifest_sha256 = announced.hash;
    if (!honest) offer.manifest_sha256.front() ^= std::byte{1};
    local.begin(session, offer);
    wait_for(BuildPhase::wanting);
    for (std::uint32_t i = 0; i < announced.pieces; ++i)
      local.receive({.session = session, .transmission = i + 1, .number = i, .content = scene->piece(i)});
    wait_for(honest ? BuildPhase::whole : BuildPhase::refused);
    if (!honest) {
      EXPECT_FALSE(local.why_refused().empty());
    }
  }
  EXPECT_EQ(local.builder().counts().refused, kSessions / 2);
  EXPECT_EQ(local.builder().counts().scenes_built, kSessions / 2);
}

}  // namespace
}  // namespace forcebound::client
