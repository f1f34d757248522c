#pragma once

#include <span>
#include <string>
#include <string_view>

#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/record/scene_part.hpp"
#include "forcebound/time/clock.hpp"

/// What pictures show, as messages of Foxglove's schemas (proto/foxglove). Private to this folder.
///
/// Times are wall-clock [since 1970]. Numbers that are not finite are shown as zero: a picture has no place for them.
namespace forcebound::record {

using time::Nanoseconds;

/// The frame that all positions are in.
inline constexpr std::string_view kSceneFrame = "scene";

/// A picture of a force that no newer one replaces is taken away after this time.
inline constexpr Nanoseconds kArrowLifetime = std::chrono::milliseconds{250};

inline constexpr double kArrow_m_per_N = 0.01;

/// An arrow from the tip, 10 mm for each newton.
struct ShownForce {
  std::string_view name;
  control::Vector force_N;
  std::array<double, 3> colour{};  ///< red, green, blue, 0 to 1
};

/// The scene, in place of what was there.
[[nodiscard]] std::string encode_scene(std::span<const ScenePart> parts, Nanoseconds at);

/// Where a device's tip is.
[[nodiscard]] std::string encode_device(std::string_view frame, const control::Vector& position_m,
                                        const control::Handle& handle, Nanoseconds at);

/// A device's tip as a small ball, and the forces on it; zero ones are not drawn.
[[nodiscard]] std::string encode_arrows(std::string_view device, const control::Vector& position_m,
                                        std::span<const ShownForce> forces, Nanoseconds at);

}  // namespace forcebound::record
