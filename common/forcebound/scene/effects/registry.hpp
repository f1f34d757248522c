#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// The effects that scene files may use, by name. A value type: a program with effects of its own adds them to its
/// copy.
class EffectRegistry {
 public:
  /// All effects that ship with the server.
  static EffectRegistry standard();

  /// @throws std::invalid_argument if the name is taken.
  void add(EffectKind kind);

  /// Null if there is none.
  [[nodiscard]] const EffectKind* find(std::string_view name) const noexcept;

  [[nodiscard]] const std::vector<EffectKind>& kinds() const noexcept { return kinds_; }

 private:
  std::vector<EffectKind> kinds_;
};

}  // namespace forcebound::scene
