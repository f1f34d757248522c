#pragma once

#include "forcebound/config/parameter.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/v1/handover.pb.h"

/// Private to handover.
namespace forcebound::handover {

/// A piece's share of Geometry::hashes and Geometry::boxes.
inline constexpr std::size_t kHashBytes = 8;
inline constexpr std::size_t kBoxBytes = 12;
inline constexpr double kBoxSteps = 65535;

/// Pieces of a mesh that a list names, so that it fits a piece.
inline constexpr std::size_t kListed = 54;
/// Meshes of more pieces than this are listed: the manifest of these is 10 kB.
inline constexpr std::size_t kUnlistedMost = 512;

/// The number of lists of so many pieces.
constexpr std::size_t lists_of(std::size_t pieces) { return (pieces + kListed - 1) / kListed; }

/// Heights of a piece along one side.
inline constexpr std::size_t kTile = 11;

using NamedValues = google::protobuf::RepeatedPtrField<v1::NamedValue>;

void fill(const config::Values& from, NamedValues* to);

/// Whatever it says; values without a type are passed over.
[[nodiscard]] config::Values values_of(const NamedValues& from);

inline void fill(const scene::Point& from, v1::PointValue* to) {
  to->set_x(from.x());
  to->set_y(from.y());
  to->set_z(from.z());
}

inline scene::Point point_of(const v1::PointValue& from) { return {from.x(), from.y(), from.z()}; }

/// The number of pieces of a grid of heights.
constexpr std::size_t tiles(std::size_t columns, std::size_t rows) {
  return ((columns + kTile - 1) / kTile) * ((rows + kTile - 1) / kTile);
}

}  // namespace forcebound::handover
