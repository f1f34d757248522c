#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/handover/packed_scene.hpp"
#include "forcebound/handover/scene_assembly.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/scene/scene_state.hpp"

namespace forcebound::client {

/// A scene of the pieces that had arrived when it was built, with its state. Made by the builder, used by the tick,
/// destroyed by the builder.
struct BuiltScene {
  std::uint64_t generation;  ///< of the offer that it belongs to
  std::uint64_t number;      ///< 1, 2, 3, ... over all
  handover::AssembledScene assembled;
  scene::SceneState state;
  BuiltScene* used_before = nullptr;  ///< the one that the tick gave back before it
};

/// How far the builder is with an offer.
enum class BuildPhase : std::uint8_t {
  nothing,  ///< there is no offer
  looking,  ///< for it in the cache
  wanting,  ///< pieces from the server
  whole,    ///< all pieces have arrived
  refused,  ///< it contradicts itself or exceeds a limit
};

/// What the builder is told by the tick.
struct BuildOrder {
  enum class Kind : std::uint8_t { begin, piece };
  Kind kind = Kind::begin;
  std::uint64_t generation = 0;
  handover::Announcement announcement{};  ///< begin; of no bytes: nothing is offered
  std::uint32_t number = 0;               ///< piece
  std::uint32_t bytes = 0;                ///< piece; longer ones than ours show by it
  std::array<std::byte, handover::kPieceBytesMax> content{};
};

/// Between the tick and the builder, which may be on another thread: a bounded queue, a list and some atomic words,
/// without locks.
///
/// Real time on the tick's side: noexcept, allocates and frees nothing, never waits.
class SceneExchange {
 public:
  SceneExchange();
  ~SceneExchange();
  SceneExchange(const SceneExchange&) = delete;
  SceneExchange& operator=(const SceneExchange&) = delete;

  // The tick's side.

  /// Another offer, or none; what comes of the one before does not count any more. False if the builder is behind: to
  /// be tried again.
  [[nodiscard]] bool begin(const handover::Announcement& announcement) noexcept;

  /// False if there is no room: the piece has to come again.
  [[nodiscard]] bool put(std::uint32_t number, std::span<const std::byte> content) noexcept;

  /// The newest scene of this offer, to be given back; null: none that was not taken yet.
  [[nodiscard]] BuiltScene* take() noexcept;
  /// @param scene null: nothing is done
  void give_back(BuiltScene* scene) noexcept;

  [[nodiscard]] BuildPhase phase() const noexcept;
  void store_place(const scene::Point& place_m) noexcept;

  // The builder's side.

  [[nodiscard]] std::optional<BuildOrder> next_order();
  void publish(std::unique_ptr<BuiltScene> scene);
  void destroy_used();
  void set_phase(std::uint64_t generation, BuildPhase phase) noexcept;
  [[nodiscard]] scene::Point place_m() const noexcept;

 private:
  struct Orders;

  std::unique_ptr<Orders> orders_;
  std::uint64_t generation_ = 0;  // the tick's
  std::atomic<BuiltScene*> fresh_{nullptr};
  std::atomic<BuiltScene*> used_{nullptr};  // the one given back last
  std::atomic<std::uint64_t> phase_{0};     // generation * 8 + phase
  std::array<std::atomic<double>, 3> place_m_{};
  BuildOrder order_;  // the tick's, so that it needs no room on the stack
};

}  // namespace forcebound::client
