#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "forcebound/answer/answer.hpp"
#include "forcebound/client/rendering/scene_exchange.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/handover/coarse_level.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

using answer::Answer;
using control::Vector;
using time::Nanoseconds;

/// The scene that runs at the device's position: takes the newest scene of the builder, and answers wherever all
/// geometry around the device has arrived.
///
/// It begins from a position at which the server found the device outside of everything, or, in contact, on the surface
/// touched, so that contacts begin on the right side; the geometry must be known around the way from there to the
/// device. Coarse levels count as known once the server's answers are older than `kCoarseSince`, until they are younger
/// than half of it: a fresh answer is less far from the truth than they are. While all geometry around the device is
/// known it goes on, also in larger parts of the scene as they arrive; otherwise it does not answer, because the border
/// of what has arrived is no surface.
///
/// Real time: `answer` is noexcept, allocates and frees nothing, and takes what the scene takes at the server, but no
/// longer than its bound on the nodes that are visited allows.
class LocalScene {
 public:
  /// Beyond any round trip, and short enough that the device's way since is nearly straight.
  static constexpr Nanoseconds kAnswerAgeMax = std::chrono::seconds{1};

  /// In which a hand at 0.1 m/s, which is a slow stroke, goes as far as a coarse level may lie off.
  static constexpr Nanoseconds kCoarseSince = time::from_seconds(handover::kCoarseErrorMost_m / 0.1);

  /// @param exchange must outlive this
  /// @param nodes_of_a_tick of the trees of meshes; where a tick would visit more, the scene does not answer
  LocalScene(SceneExchange& exchange, std::uint64_t nodes_of_a_tick)
      : exchange_(exchange), nodes_of_a_tick_(nodes_of_a_tick) {}
  ~LocalScene() { exchange_.give_back(scene_); }
  LocalScene(const LocalScene&) = delete;
  LocalScene& operator=(const LocalScene&) = delete;

  /// Another scene is to come, or none.
  void forget() noexcept;

  /// When the scene's time begins, by the device's clock: what happens at a time of its own happens as at the server.
  void set_first_time(Nanoseconds first_time) noexcept { first_time_ = first_time; }

  /// @param position of the device, with its rows; finite
  /// @param handle of the device at `device_time`
  /// @param newest of the server's answers in this scene, or null: where the device was outside, or which surface it
  /// touched. It begins from none that is older than `kAnswerAgeMax`.
  /// @returns the answer of the parts that run here; its force includes the ripples of textures
  [[nodiscard]] std::optional<Answer> answer(const Vector& position, Nanoseconds device_time,
                                             const wire::EnvironmentForce* newest,
                                             const control::Handle& handle = {}) noexcept;

  /// Whether the last answer was one.
  [[nodiscard]] bool active() const noexcept { return active_; }

  /// The last answer does not go on from that of the tick before. Where more of a scene has arrived, it does: what is
  /// about the device was known before.
  [[nodiscard]] bool swapped() const noexcept { return swapped_; }

  /// Number of the scene built that the last answer is of; 0: there was none.
  [[nodiscard]] std::uint64_t number() const noexcept { return active_ ? scene_->number : 0; }

  /// Parts whose force was not finite, and which are left out from then on.
  [[nodiscard]] std::uint64_t quarantined() const noexcept { return quarantined_; }

  /// Ticks on which it would have visited more nodes than its bound, and did not answer.
  [[nodiscard]] std::uint64_t searches_exhausted() const noexcept { return searches_exhausted_; }

 private:
  void adopt() noexcept;
  [[nodiscard]] bool knows_about(const scene::Point& place_m, double more_m) const noexcept;
  [[nodiscard]] bool begin(const Vector& position, const scene::Point& place_m,
                           const wire::EnvironmentForce& newest) noexcept;

  SceneExchange& exchange_;
  std::uint64_t nodes_of_a_tick_;
  BuiltScene* scene_ = nullptr;  // the builder's to destroy; null: none of this offer
  bool active_ = false;
  bool swapped_ = false;
  bool coarse_counts_ = false;  // as known
  double depth_m_ = 0;
  std::uint64_t quarantined_ = 0;
  std::uint64_t searches_exhausted_ = 0;
  Nanoseconds first_time_{0};
};

}  // namespace forcebound::client
