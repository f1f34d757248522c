#include "forcebound/client/rendering/scene_exchange.hpp"

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>
#include <utility>

namespace forcebound::client {
namespace {

constexpr std::uint64_t kPhases = 8;

}  // namespace

struct SceneExchange::Orders : boost::lockfree::spsc_queue<BuildOrder> {
  Orders() : spsc_queue(512) {
    // Touched here, not by the tick: a page's first use costs a fault.
    while (push(BuildOrder())) {
    }
    consume_all([](const BuildOrder&) {});
  }
};

SceneExchange::SceneExchange() : orders_(std::make_unique<Orders>()) {}

SceneExchange::~SceneExchange() {
  destroy_used();
  delete fresh_.load();
}

bool SceneExchange::begin(const handover::Announcement& announcement) noexcept {
  order_.kind = BuildOrder::Kind::begin;
  order_.generation = generation_ + 1;
  order_.announcement = announcement;
  const bool pushed = orders_->push(order_);
  generation_ += pushed ? 1 : 0;
  return pushed;
}

bool SceneExchange::put(std::uint32_t number, std::span<const std::byte> content) noexcept {
  order_.kind = BuildOrder::Kind::piece;
  order_.generation = generation_;
  order_.number = number;
  order_.bytes = static_cast<std::uint32_t>(content.size());
  std::copy_n(content.begin(), std::min(content.size(), order_.content.size()), order_.content.begin());
  return orders_->push(order_);
}

BuiltScene* SceneExchange::take() noexcept {
  if (fresh_.load(std::memory_order_relaxed) == nullptr) return nullptr;
  BuiltScene* const next = fresh_.exchange(nullptr, std::memory_order_acq_rel);
  if (next == nullptr || next->generation == generation_) return next;
  give_back(next);
  return nullptr;
}

void SceneExchange::give_back(BuiltScene* scene) noexcept {
  if (scene == nullptr) return;
  scene->used_before = used_.load(std::memory_order_relaxed);
  // Tried twice at most: the builder alone changes it meanwhile, to null.
  while (!used_.compare_exchange_strong(scene->used_before, scene, std::memory_order_acq_rel)) {
  }
}

BuildPhase SceneExchange::phase() const noexcept {
  const std::uint64_t word = phase_.load(std::memory_order_acquire);
  if (word / kPhases != generation_) return generation_ == 0 ? BuildPhase::nothing : BuildPhase::looking;
  return static_cast<BuildPhase>(word % kPhases);
}

void SceneExchange::store_place(const scene::Point& place_m) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis)
    place_m_[axis].store(place_m[static_cast<Eigen::Index>(axis)], std::memory_order_relaxed);
}

std::optional<BuildOrder> SceneExchange::next_order() {
  BuildOrder order;
  if (!orders_->pop(order)) return std::nullopt;
  return order;
}

void SceneExchange::publish(std::unique_ptr<BuiltScene> scene) {
  // What the tick did not take yet is old by now.
  delete fresh_.exchange(scene.release(), std::memory_order_acq_rel);
}

void SceneExchange::destroy_used() {
  BuiltScene* scene = used_.exchange(nullptr, std::memory_order_acq_rel);
  while (scene != nullptr) delete std::exchange(scene, scene->used_before);
}

void SceneExchange::set_phase(std::uint64_t generation, BuildPhase phase) noexcept {
  phase_.store(generation * kPhases + static_cast<std::uint64_t>(phase), std::memory_order_release);
}

scene::Point SceneExchange::place_m() const noexcept {
  return {place_m_[0].load(std::memory_order_relaxed), place_m_[1].load(std::memory_order_relaxed),
          place_m_[2].load(std::memory_order_relaxed)};
}

}  // namespace forcebound::client
