#include "forcebound/handover/internal/two_levels.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace forcebound::handover {
namespace {

// Motions over which the difference of two levels fades: 10 ms at 1 kHz.
constexpr std::uint32_t kFade = 10;
// Beyond what must be known of the mesh, so that levels do not alternate at its border.
constexpr double kFurther_m = 1e-3;

/// From the device to where the surface holds it back.
Point held_back_m(const scene::SurfacePoint& surface) noexcept {
  return std::max(0.0, surface.penetration_m) * surface.normal;
}

}  // namespace

/// Flat bytes, zeros at first; those of the two levels follow.
struct TwoLevels::State {
  double offset_m[3];  // of the level before from this one, when this one took over
  double depth_m;      // on the last motion
  std::uint32_t fading;
  Level level;

  [[nodiscard]] Point faded_offset_m() const noexcept {
    return static_cast<double>(fading) / kFade * Point(offset_m[0], offset_m[1], offset_m[2]);
  }
};

TwoLevels::TwoLevels(Coarse coarse, Full full, double reach_m)
    : coarse_(std::move(coarse)), full_(std::move(full)), reach_m_(reach_m) {
  const std::size_t most =
      std::max(coarse_.shape->facts().state_bytes, full_.shape ? full_.shape->facts().state_bytes : 0);
  level_bytes_ = (most + alignof(State) - 1) / alignof(State) * alignof(State);
}

bool TwoLevels::knows(const Point& position_m, double depth_m, double more_m) const noexcept {
  return full_.shape != nullptr &&
         full_.known.known_within_m(position_m) >= std::max(depth_m, reach_m_) + kBorder_m + more_m;
}

TwoLevels::Level TwoLevels::level_at(const Point& position_m, const State& state) const noexcept {
  const double more_m = state.level == Level::coarse ? coarse_.error_m + kFurther_m : 0;
  return knows(position_m, state.depth_m, more_m) ? Level::full : Level::coarse;
}

std::byte* TwoLevels::state_of(Level level, std::byte* state) const noexcept {
  return state + sizeof(State) + (level == Level::full ? level_bytes_ : 0);
}

scene::SurfacePoint TwoLevels::nearest(const Point& position_m, std::byte* state) const noexcept {
  State& own = *std::launder(reinterpret_cast<State*>(state));
  const Level level = level_at(position_m, own);
  if (own.level != Level::none && own.level != level) change(position_m, level, state);
  own.level = level;
  scene::SurfacePoint surface = shape(level).nearest(position_m, state_of(level, state));
  if (own.fading > 0) {
    const Point back_m = held_back_m(surface) + own.faded_offset_m();
    --own.fading;
    const double depth_m = back_m.norm();
    if (depth_m > 0) surface = {.normal = back_m / depth_m, .penetration_m = depth_m};
  }
  own.depth_m = std::max(0.0, surface.penetration_m);
  return surface;
}

void TwoLevels::change(const Point& position_m, Level to, std::byte* state) const noexcept {
  State& own = *std::launder(reinterpret_cast<State*>(state));
  const Point back_m = held_back_m(shape(own.level).nearest(position_m, state_of(own.level, state)));
  std::byte* const begun = state_of(to, state);
  std::fill_n(begun, level_bytes_, std::byte{0});
  shape(to).begin_outside(position_m + back_m, begun);
  const Point offset_m = back_m + own.faded_offset_m() - held_back_m(shape(to).nearest(position_m, begun));
  for (Eigen::Index axis = 0; axis < 3; ++axis) own.offset_m[axis] = offset_m[axis];
  own.fading = kFade;
}

void TwoLevels::begin_outside(const Point& free_m, std::byte* state) const noexcept {
  State& own = *std::launder(reinterpret_cast<State*>(state));
  own.level = level_at(free_m, own);
  shape(own.level).begin_outside(free_m, state_of(own.level, state));
}

bool TwoLevels::is_clear_of(const Point& center_m, double radius_m) const noexcept {
  return coarse_.shape->is_clear_of(center_m, radius_m) &&
         (full_.shape == nullptr || full_.shape->is_clear_of(center_m, radius_m));
}

scene::ShapeFacts TwoLevels::facts() const {
  scene::ShapeFacts facts = coarse_.shape->facts();
  facts.state_bytes = sizeof(State) + 2 * level_bytes_;
  if (full_.shape == nullptr) return facts;
  const scene::ShapeFacts full = full_.shape->facts();
  facts.memory_bytes += full.memory_bytes;
  facts.cost_ns += full.cost_ns;
  facts.bounds_m.extend(full.bounds_m);
  return facts;
}

scene::ShapeGeometry TwoLevels::geometry() const {
  return (full_.shape != nullptr && full_.known.whole() ? full_.shape : coarse_.shape)->geometry();
}

}  // namespace forcebound::handover
