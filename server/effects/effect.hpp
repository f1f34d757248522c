#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "forcebound/server/geometry/point.hpp"

namespace forcebound::server {

/// The device's point, seen by an object that it has entered. Everything is finite.
struct Probe {
  Point position_m;
  Point velocity_m_per_s;    ///< mean since the previous motion; zero on the first, and where no effect needs it
  Point normal;              ///< unit, out of the object's surface where it is nearest
  double penetration_m = 0;  ///< depth below that surface, > 0
};

/// What one object does to the device's point: motion in, force out. One file per effect.
///
/// Real time: `force_N` is noexcept, allocates nothing and takes bounded time. Immutable, so that every client's scene
/// state shares it.
class Effect {
 public:
  virtual ~Effect() = default;

  /// Force on the device [N], scene frame.
  [[nodiscard]] virtual Point force_N(const Probe& probe) const noexcept = 0;

  /// Whether `probe.velocity_m_per_s` is looked at: the plan estimates it only if some effect does.
  [[nodiscard]] virtual bool needs_velocity() const noexcept { return false; }
};

/// A number that a scene gives an effect, with its unit in the key. What is not finite or outside is refused at load.
struct EffectParameter {
  std::string_view key;
  std::optional<double> preset;  ///< value where the scene is silent; none: the scene must say
  double least = -std::numeric_limits<double>::infinity();
  bool least_excluded = false;
  double most = std::numeric_limits<double>::infinity();
};

/// An effect as a scene file knows it.
struct EffectKind {
  std::string_view name;                    ///< in `effects = [...]`, and of its own table
  std::string_view law;                     ///< its equation in one line, for people
  std::vector<EffectParameter> parameters;  ///< every key its table may have
  std::unique_ptr<Effect> (*make)(std::span<const double> values) = nullptr;  ///< values in the order of `parameters`
};

}  // namespace forcebound::server
