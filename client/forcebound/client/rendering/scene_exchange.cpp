#include "forcebound/client/rendering/scene_exchange.hpp"

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>

namespace forcebound::client {
namespace {

constexpr std::uint64_t kPhases = 8;

}  // namespace

struct SceneExchange::Queues {
  static constexpr std::size_t kOrders = 512;
  static constexpr std::size_t kUsed = 16;

  Queues() : orders(kOrders), used(kUsed) {
    // Touched here, not by the tick: a page's first use costs a fault.
    while (orders.push(BuildOrder())) {
    }
    orders.consume_all([](const BuildOrder&) {});
  }
  boost::lockfree::spsc_queue<BuildOrder> orders;
  boost::lockfree::spsc_queue<BuiltScene*> used;
};

SceneExchange::SceneExchange() : queues_(std::make_unique<Queues>()) {}

SceneExchange::~SceneExchange() {
  destroy_used();
  delete fresh_.load();
}

bool SceneExchange::begin(const handover::Announcement& announcement) noexcept {
  order_.kind = BuildOrder::Kind::begin;
  order_.generation = generation_ + 1;
  order_.announcement = announcement;
  const bool pushed = queues_->orders.push(order_);
  generation_ += pushed ? 1 : 0;
  return pushed;
}

bool SceneExchange::end() noexcept {
  order_.kind = BuildOrder::Kind::end;
  order_.generation = generation_ + 1;
  const bool pushed = queues_->orders.push(order_);
  generation_ += pushed ? 1 : 0;
  return pushed;
}

bool SceneExchange::put(std::uint32_t number, std::span<const std::byte> content) noexcept {
  order_.kind = BuildOrder::Kind::piece;
  order_.generation = generation_;
  order_.number = number;
  order_.bytes = static_cast<std::uint32_t>(content.size());
  std::copy_n(content.begin(), std::min(content.size(), order_.content.size()), order_.content.begin());
  return queues_->orders.push(order_);
}

BuiltScene* SceneExchange::take(BuiltScene* last) noexcept {
  // One place for the scene that goes back, one for a scene of an offer that does not count any more.
  if (fresh_.load(std::memory_order_relaxed) == nullptr || queues_->used.write_available() < 2) return last;
  BuiltScene* const next = fresh_.exchange(nullptr, std::memory_order_acq_rel);
  if (next == nullptr) return last;
  if (next->generation != generation_) {
    (void)queues_->used.push(next);
    return last;
  }
  return next;
}

bool SceneExchange::give_back(BuiltScene* scene) noexcept { return scene == nullptr || queues_->used.push(scene); }

BuildPhase SceneExchange::phase() const noexcept {
  const std::uint64_t word = phase_.load(std::memory_order_acquire);
  if (word / kPhases != generation_) return generation_ == 0 ? BuildPhase::nothing : BuildPhase::looking;
  return static_cast<BuildPhase>(word % kPhases);
}

void SceneExchange::note_place(const scene::Point& place_m) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis)
    place_m_[axis].store(place_m[static_cast<Eigen::Index>(axis)], std::memory_order_relaxed);
}

std::optional<BuildOrder> SceneExchange::next_order() {
  BuildOrder order;
  if (!queues_->orders.pop(order)) return std::nullopt;
  return order;
}

void SceneExchange::publish(std::unique_ptr<BuiltScene> scene) {
  // What the tick did not take yet is old by now.
  delete fresh_.exchange(scene.release(), std::memory_order_acq_rel);
}

void SceneExchange::destroy_used() {
  queues_->used.consume_all([](BuiltScene* scene) { delete scene; });
}

void SceneExchange::set_phase(std::uint64_t generation, BuildPhase phase) noexcept {
  phase_.store(generation * kPhases + static_cast<std::uint64_t>(phase), std::memory_order_release);
}

scene::Point SceneExchange::place_m() const noexcept {
  return {place_m_[0].load(std::memory_order_relaxed), place_m_[1].load(std::memory_order_relaxed),
          place_m_[2].load(std::memory_order_relaxed)};
}

}  // namespace forcebound::client
