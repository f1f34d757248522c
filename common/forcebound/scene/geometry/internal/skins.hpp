#pragma once

/// How near the god object tells things apart, in skins: a skin is 2^-40 (1e-12) of a mesh's size.
namespace forcebound::scene {

inline constexpr double kSkin = 0x1p-40;
inline constexpr double kOnSkins = 0x1p-6;
inline constexpr double kEdgeSkins = 4;
// A point this far below a triangle, by rounding, is not yet behind it.
inline constexpr double kBehindSkins = 2;
// Where both sides are felt, what a triangle holds beyond its edges and corners may lie on the other side of the
// surface. The god object keeps farther away than that, so that it never meets a triangle from there.
inline constexpr double kClearanceSkins = 16;
inline constexpr double kCornerSkins = 8;
// Where a surface rises beyond an edge, rounding must not let the god object slip past the rising wall while it follows
// the edge down to the bottom of a wedge, however narrow. Reaching further beyond the edge is harmless: that is behind
// the rising wall, where nothing is felt. Where both sides are felt, the clearance keeps it over both walls.
inline constexpr double kRisingEdgeSkins = 0x1p12;
inline constexpr double kRisingBelowSkins = 0x1p-6;
// Where the surface ends at the edge.
inline constexpr double kOpenBelowSkins = 0x1p-3;
// Triangles this near to the god object are its surroundings: more than it may be beyond an edge.
inline constexpr double kAboutSkins = 0x1p13;
// A contact no deeper than this takes its direction from the triangle.
inline constexpr double kShallowSkins = 64;

}  // namespace forcebound::scene
