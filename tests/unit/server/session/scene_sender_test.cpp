#include "forcebound/server/session/scene_sender.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "forcebound/client/rendering/piece_receipts.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<const handover::PackedScene> ball() {
  return handover::pack(*handover::mesh_scene(test::ball(0.03, 40)));
}

/// A client some way off, which gets pieces and sends motions each millisecond.
class FarClient {
 public:
  FarClient(SceneSender& sender, Nanoseconds way, double loss, std::uint64_t seed)
      : sender_(sender), way_(way), loss_(loss), random_(seed) {}

  void live(Nanoseconds until) {
    for (; now_ < until; now_ += 1ms) {
      while (!down_.empty() && down_.begin()->first <= now_) {
        receipts_.add(down_.begin()->second.transmission);
        got.insert(down_.begin()->second.number);
        down_.erase(down_.begin());
      }
      up_.emplace(now_ + way_,
                  wire::MotionSample{
                      .sequence = 1, .device_time = now_, .position = place_m, .pieces = receipts_.receipt(wanted)});
      while (!up_.empty() && up_.begin()->first <= now_) {
        sender_.on_motion(up_.begin()->second, now_);
        up_.erase(up_.begin());
        if (const auto sent = sender_.next(now_)) {
          order.push_back(sent->number);
          sent_again += sent->again ? 1 : 0;
          if (std::uniform_real_distribution<>(0, 1)(random_) >= loss_) down_.emplace(now_ + way_, *sent);
        }
      }
    }
  }

  std::set<std::uint32_t> got;
  std::vector<std::uint32_t> order;
  int sent_again = 0;
  bool wanted = true;
  control::Vector place_m = scene::Point(0, 0, 0.04);

 private:
  SceneSender& sender_;
  Nanoseconds way_;
  double loss_;
  std::mt19937_64 random_;
  Nanoseconds now_{0};
  client::PieceReceipts receipts_;
  std::multimap<Nanoseconds, wire::MotionSample> up_;
  std::multimap<Nanoseconds, SceneSender::Sending> down_;
};

TEST(SceneSender, SendsNothingUnlessItIsWanted) {
  const auto scene = ball();
  SceneSender sender(scene, {}, 0ms);
  FarClient client(sender, 10ms, 0, 1);
  client.wanted = false;
  client.live(1s);
  EXPECT_TRUE(client.order.empty());
}

TEST(SceneSender, SendsEachPieceOnceWhereNothingIsLostAndNearestFirst) {
  const auto scene = ball();
  // Each is acknowledged before the next one leaves.
  SceneSender sender(scene, {.bytes_per_s = 100e3, .pieces_at_once = 1}, 0ms);
  FarClient client(sender, 5ms, 0, 1);
  client.live(20s);
  EXPECT_EQ(client.got.size(), scene->announcement().pieces);
  EXPECT_EQ(client.order.size(), scene->announcement().pieces);
  EXPECT_EQ(client.sent_again, 0);
  const std::size_t of_manifest = handover::manifest_pieces(scene->announcement().manifest_bytes);
  double last_m = 0;
  for (std::size_t i = 0; i < client.order.size(); ++i) {
    if (i < of_manifest) {
      EXPECT_EQ(client.order[i], i);
      continue;
    }
    const double away_m = scene->where_m(client.order[i]).exteriorDistance(scene::Point(client.place_m));
    EXPECT_GE(away_m, last_m - 1e-12);
    last_m = away_m;
  }
}

TEST(SceneSender, SendsTheManifestThenTheCoarseLevelAndThenTheRest) {
  const auto scene = handover::pack(*handover::mesh_scene(test::ball(0.03, 60)));
  SceneSender sender(scene, {.bytes_per_s = 100e3, .pieces_at_once = 1}, 0ms);
  FarClient client(sender, 5ms, 0, 1);
  client.live(20s);
  ASSERT_EQ(client.order.size(), scene->announcement().pieces);
  const auto comes_first = [&](std::uint32_t number) { return scene->comes_first(number); };
  EXPECT_TRUE(std::ranges::is_partitioned(client.order, comes_first));
  const auto rest = std::ranges::partition_point(client.order, comes_first);
  EXPECT_TRUE(std::is_sorted(client.order.begin(), rest));
  const std::size_t of_manifest = handover::manifest_pieces(scene->announcement().manifest_bytes);
  EXPECT_GT(static_cast<std::size_t>(rest - client.order.begin()), of_manifest + 20);
}

TEST(SceneSender, SendsTwiceAtOnceWhatComesFirstAndIsNotAcknowledgedByThen) {
  const auto scene = handover::pack(*handover::mesh_scene(test::ball(0.03, 60)));
  std::vector<std::uint32_t> first;
  for (std::uint32_t number = 0; number < scene->announcement().pieces; ++number) {
    if (scene->comes_first(number)) first.push_back(number);
  }
  ASSERT_GT(first.size(), 20U);
  SceneSender sender(scene, {}, 0ms);
  FarClient client(sender, 500ms, 0, 1);
  client.live(999ms);
  ASSERT_GT(client.order.size(), 2 * first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(client.order[i], first[i]);
    EXPECT_EQ(client.order[first.size() + i], first[i]) << "no word of it yet";
  }
  EXPECT_FALSE(scene->comes_first(client.order[2 * first.size()])) << "no third time within a round trip";
}

TEST(SceneSender, SendsAgainWhatWasLostUntilAllIsThere) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const auto scene = ball();
    SceneSender sender(scene, {}, 0ms);
    FarClient client(sender, 50ms, 0.3, seed);
    client.live(10s);
    EXPECT_EQ(client.got.size(), scene->announcement().pieces);
    EXPECT_GT(client.sent_again, 0);
    // Of so many a third is lost, and a third of these.
    EXPECT_LT(client.order.size(), 2 * scene->announcement().pieces);
  }
}

TEST(SceneSender, KeepsToItsRate) {
  const auto scene = ball();
  SceneSender sender(scene, {.bytes_per_s = 50e3, .pieces_at_once = 4}, 0ms);
  FarClient client(sender, 1ms, 0, 1);
  client.live(1s);
  EXPECT_NEAR(static_cast<double>(client.order.size()), 4 + 50e3 / 1180, 2);
}

/// What is sent at once to a device at the ball's middle, whose encoder steps to and fro by so much.
std::vector<std::uint32_t> sent_at_once(double step_m) {
  SceneSender sender(ball(), {}, 0ms);
  wire::MotionSample motion{.sequence = 1, .position = scene::Point(0, 0, 0)};
  motion.pieces.wanted = true;
  std::vector<std::uint32_t> numbers;
  numbers.reserve(32);
  for (int i = 0; i < 32; ++i) {
    motion.device_time = i * 1ms;
    motion.position[0] = i % 2 == 0 ? 0 : step_m;
    sender.on_motion(motion, motion.device_time);
    if (const auto sent = sender.next(motion.device_time)) numbers.push_back(sent->number);
  }
  return numbers;
}

TEST(SceneSender, TakesAnEncodersStepsForNoWay) {
  const auto still = sent_at_once(0);
  EXPECT_EQ(still.size(), 32U);
  EXPECT_EQ(sent_at_once(20e-6), still) << "20 mm/s to and fro, but no way";
}

TEST(SceneSender, BelievesNoReceiptOfWhatWasNeverSent) {
  const auto scene = ball();
  SceneSender sender(scene, {}, 0ms);
  wire::MotionSample motion{.sequence = 1, .position = scene::Point(0, 0, 0)};
  motion.pieces = {.wanted = true, .newest = ~std::uint64_t{0}, .before = ~std::uint64_t{0}};
  sender.on_motion(motion, 1ms);
  const auto first = sender.next(1ms);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->number, 0U);
  EXPECT_FALSE(first->again);
}

TEST(SceneSender, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto scene = ball();
  SceneSender sender(scene, {}, 0ms);
  wire::MotionSample motion{.sequence = 1, .position = scene::Point(0, 0, 0)};
  motion.pieces.wanted = true;
  const test::AllocationGuard guard;
  for (int i = 1; i < 2000; ++i) {
    motion.position[0] = 0.03 * std::sin(0.01 * i);
    sender.on_motion(motion, i * 1ms);
    if (const auto sent = sender.next(i * 1ms)) motion.pieces.newest = sent->transmission;
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
