#pragma once

#include <string_view>
#include <vector>

#include "forcebound/scene/effects/effect.hpp"
#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// The shapes and effects that scenes may use, by name. A value type: a program adds its own to its copy.
class Registry {
 public:
  /// All shapes and effects of this library.
  static Registry standard();

  /// @throws std::invalid_argument if the name is taken, here or by another kind of this library: a client that is
  /// handed a scene runs what it knows by the name.
  void add(EffectKind kind);
  void add(ShapeKind kind);

  /// Null if there is none.
  [[nodiscard]] const EffectKind* find_effect(std::string_view name) const noexcept;
  [[nodiscard]] const ShapeKind* find_shape(std::string_view name) const noexcept;

  [[nodiscard]] const std::vector<EffectKind>& effects() const noexcept { return effects_; }
  [[nodiscard]] const std::vector<ShapeKind>& shapes() const noexcept { return shapes_; }

 private:
  std::vector<EffectKind> effects_;
  std::vector<ShapeKind> shapes_;
};

}  // namespace forcebound::scene
