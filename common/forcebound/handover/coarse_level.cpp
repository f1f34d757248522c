#include "forcebound/handover/coarse_level.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "forcebound/handover/handover_error.hpp"
#include "forcebound/handover/limits.hpp"
#include "forcebound/scene/geometry/decimate.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::handover {
namespace {

using scene::Bvh;
using scene::Point;

// Triangles: 2,000 are 60 pieces, which an eighth of a second brings. If these lie too far off, so many times more, as
// long as they come soon and are few beside the mesh's.
constexpr double kFewest = 2000;
constexpr double kStep = 2;
constexpr double kMost = 8000;
constexpr double kLeastRatio = 4;
// Rounding of a vertex that is read from its own frame.
constexpr double kRounding = 1e-9;

using Corners = std::array<Point, 3>;

/// Bounds the distance from triangles to a surface. From a point it is known, at other points it differs by no more
/// than these are away; and from one triangle to another one it is the largest at a corner, since a triangle is convex.
/// What these do not bound well is cut into four, as long as not too much has been looked at.
class Deviation {
 public:
  /// @param least_m what the largest distance is known to be at least
  Deviation(const Bvh& to, double least_m)
      : to_(to), least_m_(least_m), small_m_(std::min(kSmall * to.mesh().size_m(), kCoarseErrorMost_m / 2)) {}

  void add(const Corners& corners_m) {
    ++looked_at_;
    const Point middle_m = (corners_m[0] + corners_m[1] + corners_m[2]) / 3;
    const auto found = to_.nearest(middle_m);
    double away_m = 0;
    double at_corners_m = 0;
    for (const Point& corner_m : corners_m) {
      away_m = std::max(away_m, (corner_m - middle_m).norm());
      at_corners_m = std::max(at_corners_m, (to_.nearest_on(found->triangle, corner_m).point_m - corner_m).norm());
    }
    least_m_ = std::max(least_m_, found->distance_m);
    const double bound_m = std::min(found->distance_m + away_m, at_corners_m);
    if (looked_at_ > kLookedAtMost || bound_m <= std::max(kLoose * least_m_, small_m_)) {
      most_m_ = std::max(most_m_, bound_m);
      return;
    }
    const auto& [a, b, c] = corners_m;
    const Corners between{Point(0.5 * (b + c)), Point(0.5 * (c + a)), Point(0.5 * (a + b))};
    for (const Corners& part :
         {between, Corners{a, between[2], between[1]}, {between[2], b, between[0]}, {between[1], between[0], c}}) {
      add(part);
    }
  }

  [[nodiscard]] double least_m() const noexcept { return least_m_; }
  [[nodiscard]] double most_m() const noexcept { return most_m_; }

 private:
  static constexpr double kLoose = 1.5;
  static constexpr double kSmall = 0x1p-8;
  static constexpr std::size_t kLookedAtMost = 1'000'000;

  const Bvh& to_;
  double least_m_;
  double small_m_;
  double most_m_ = 0;
  std::size_t looked_at_ = 0;
};

/// From the frame of one mesh to that of another.
Point shift_m(const Bvh& from, const Bvh& to) { return from.mesh().origin_m() - to.mesh().origin_m(); }

Deviation deviation(const Bvh& from, const Bvh& to, double least_m) {
  Deviation found(to, least_m);
  const Point shift = shift_m(from, to);
  for (std::size_t i = 0; i < from.mesh().triangles().size(); ++i) {
    found.add({Point(from.mesh().corner_m(i, 0) + shift), Point(from.mesh().corner_m(i, 1) + shift),
               Point(from.mesh().corner_m(i, 2) + shift)});
  }
  return found;
}

double farthest_vertex_m(const Bvh& from, const Bvh& to) {
  const Point shift = shift_m(from, to);
  double farthest_m = 0;
  for (const Point& vertex_m : from.mesh().vertices_m()) {
    const auto found = to.nearest(vertex_m + shift);
    if (scene::SearchBudget::exhausted()) throw HandoverError("a mesh and its coarse level take too long to compare");
    farthest_m = std::max(farthest_m, found->distance_m);
  }
  return farthest_m;
}

/// Where slivers were dropped.
bool has_gap(const scene::TriangleMesh& mesh) {
  return std::ranges::any_of(mesh.neighbours(), [](const scene::Triangle& beyond) {
    return std::ranges::find(beyond, scene::TriangleMesh::kNone) != beyond.end();
  });
}

}  // namespace

double error_between_m(const Bvh& one, const Bvh& other) {
  const Deviation there = deviation(one, other, farthest_vertex_m(one, other));
  return std::max(there.most_m(), deviation(other, one, there.least_m()).most_m());
}

std::optional<CoarseLevel> coarse_level_of(const Bvh& tree) {
  const scene::TriangleMesh& mesh = tree.mesh();
  if (!mesh.report().closed() || has_gap(mesh)) return {};
  const auto all = static_cast<double>(mesh.triangles().size());
  // A client takes no more triangles than that, of both together.
  if (all + kMost > static_cast<double>(Limits().triangles)) return {};
  for (double triangles = kFewest; triangles <= std::min(kMost, all / kLeastRatio); triangles *= kStep) {
    auto coarse = std::make_shared<const scene::TriangleMesh>(decimated(mesh, triangles / all));
    const double error_m = error_between_m(Bvh(coarse), tree);
    if (coarse->report().closed() && error_m <= kCoarseErrorMost_m)
      return CoarseLevel{.mesh = std::move(coarse), .error_m = error_m};
  }
  return {};
}

void check_error(const Bvh& coarse, double error_m, const Bvh& full, bool whole) {
  const double found_m = std::max(farthest_vertex_m(full, coarse), whole ? farthest_vertex_m(coarse, full) : 0.0);
  if (found_m <= error_m + kRounding * full.mesh().size_m()) return;
  throw HandoverError("a coarse level of a mesh says that it is within " + text::rounded(error_m) +
                      " m of it, but lies " + text::rounded(found_m) + " m off");
}

}  // namespace forcebound::handover
