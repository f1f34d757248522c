#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "forcebound/handover/coverage.hpp"
#include "forcebound/scene/geometry/shape.hpp"

/// Private to handover.
namespace forcebound::handover {

/// A shape of a geometry that has not arrived everywhere: where it has, as far as it is felt there, the shape itself;
/// elsewhere that of its coarse level, which is whole.
///
/// Where one takes over from the other, a contact begins on the new surface beside the place at which the old one held
/// the device back, and the difference of both fades over the next motions: the force goes on from what it was.
///
/// Real time: as the two shapes.
class TwoLevels final : public scene::Shape {
 public:
  struct Coarse {
    std::shared_ptr<const scene::Shape> shape;
    double error_m;
  };
  /// Of the same kind as the coarse level, so that its state is as large.
  struct Full {
    std::shared_ptr<const scene::Shape> shape;  ///< null: nothing of it is there
    Coverage known{};
  };

  /// @param reach_m distances to the surface matter up to this outside
  TwoLevels(Coarse coarse, Full full, double reach_m);

  scene::SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override;
  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override;
  scene::ShapeFacts facts() const override;
  scene::ShapeGeometry geometry() const override;
  void begin_outside(const Point& free_m, std::byte* state) const noexcept override;

 private:
  enum class Level : std::uint8_t { none, coarse, full };
  struct State;

  /// @param more_m than what is felt
  [[nodiscard]] bool knows(const Point& position_m, double depth_m, double more_m) const noexcept;
  [[nodiscard]] Level level_at(const Point& position_m, const State& state) const noexcept;
  [[nodiscard]] const scene::Shape& shape(Level level) const noexcept {
    return level == Level::full ? *full_.shape : *coarse_.shape;
  }
  [[nodiscard]] std::byte* state_of(Level level, std::byte* state) const noexcept;
  void change(const Point& position_m, Level to, std::byte* state) const noexcept;

  Coarse coarse_;
  Full full_;
  double reach_m_;
  std::size_t level_bytes_;  // of a level's state
};

}  // namespace forcebound::handover
