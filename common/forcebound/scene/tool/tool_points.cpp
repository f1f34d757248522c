#include "forcebound/scene/tool/tool_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

constexpr std::array<std::string_view, 5> kKinds{"box", "capsule", "cylinder", "mesh", "sphere"};

/// As few intervals as are no longer than the spacing, at least one.
double intervals(double length_m, double spacing_m) { return std::max(1.0, std::ceil(length_m / spacing_m - 1e-9)); }

void refuse_too_many(double points, double spacing_m) {
  if (points <= static_cast<double>(kToolPointsMost)) return;
  throw std::invalid_argument("a part with points spacing_m " + text::to_text(spacing_m) +
                              " apart has more than 10000, the most that are accepted: a larger spacing_m is needed");
}

std::vector<ToolPoint> points_of_box(const Point& center_m, const Point& size_m, double spacing_m) {
  const Point n = size_m.unaryExpr([&](double length_m) { return intervals(length_m, spacing_m); });
  const Point all = n.array() + 1;
  const Point inner = n.array() - 1;
  refuse_too_many(all.prod() - inner.prod(), spacing_m);
  std::vector<ToolPoint> points;
  const auto at = [](double i, double count) { return i / count - 0.5; };
  for (double x = 0; x <= n.x(); ++x) {
    for (double y = 0; y <= n.y(); ++y) {
      const bool on_side = x == 0 || x == n.x() || y == 0 || y == n.y();
      for (double z = 0; z <= n.z(); z += on_side ? 1 : n.z()) {
        points.push_back({center_m + size_m.cwiseProduct(Point(at(x, n.x()), at(y, n.y()), at(z, n.z())))});
      }
    }
  }
  return points;
}

std::vector<ToolPoint> points_of_capsule(const Point& from_m, const Point& to_m, double radius_m, double spacing_m) {
  const double n = intervals((to_m - from_m).norm(), spacing_m);
  refuse_too_many(n + 1, spacing_m);
  std::vector<ToolPoint> points;
  for (double i = 0; i <= n; ++i) points.push_back({from_m + i / n * (to_m - from_m), radius_m});
  return points;
}

std::vector<ToolPoint> points_of_cylinder(const Point& from_m, const Point& to_m, double radius_m, double spacing_m) {
  const double along = intervals((to_m - from_m).norm(), spacing_m);
  const double rings = intervals(radius_m, spacing_m);
  const double around = std::max(3.0, intervals(2 * std::numbers::pi * radius_m, spacing_m));
  refuse_too_many(around * (along + 1 + rings), spacing_m);
  const Point axis = (to_m - from_m).normalized();
  const Point x = axis.unitOrthogonal();
  const Point y = axis.cross(x);
  std::vector<ToolPoint> points;
  const auto add_ring = [&](const Point& middle_m, double ring_m) {
    const double n = std::max(3.0, intervals(2 * std::numbers::pi * ring_m, spacing_m));
    for (double i = 0; i < n; ++i) {
      const double turn = 2 * std::numbers::pi * i / n;
      points.push_back({middle_m + ring_m * (std::cos(turn) * x + std::sin(turn) * y)});
    }
  };
  for (double i = 0; i <= along; ++i) add_ring(from_m + i / along * (to_m - from_m), radius_m);
  for (const Point& end_m : {from_m, to_m}) {
    points.push_back({end_m});
    for (double i = 1; i < rings; ++i) add_ring(end_m, i / rings * radius_m);
  }
  return points;
}

/// Points of which none is nearer to another one than a distance: a grid of cells as wide as that.
class Spaced {
 public:
  Spaced(double apart_m, double spacing_m) : apart_m_(apart_m), spacing_m_(spacing_m) {}

  void add(const Point& at_m) {
    const Cell cell = (at_m / apart_m_).array().floor().cast<std::int64_t>();
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto [first, end] = in_cells_.equal_range(number_of(cell + Cell(x, y, z)));
          const bool near = std::any_of(first, end, [&](const auto& entry) {
            return (points_[entry.second].at_m - at_m).squaredNorm() < apart_m_ * apart_m_;
          });
          if (near) return;
        }
      }
    }
    refuse_too_many(static_cast<double>(points_.size() + 1), spacing_m_);
    in_cells_.emplace(number_of(cell), points_.size());
    points_.push_back({at_m});
  }

  [[nodiscard]] std::vector<ToolPoint> take() { return std::move(points_); }

 private:
  using Cell = Eigen::Array<std::int64_t, 3, 1>;

  [[nodiscard]] static std::uint64_t number_of(const Cell& cell) noexcept {
    const auto of = [](std::int64_t i) { return static_cast<std::uint64_t>(i); };
    return of(cell.x()) * 73856093U ^ of(cell.y()) * 19349663U ^ of(cell.z()) * 83492791U;
  }

  double apart_m_;
  double spacing_m_;
  std::vector<ToolPoint> points_;
  std::unordered_multimap<std::uint64_t, std::size_t> in_cells_;
};

void check_mesh(const TriangleMesh& mesh) {
  const MeshReport& report = mesh.report();
  if (report.triangles > kToolTrianglesMost) {
    throw std::invalid_argument(mesh.name() + ": a tool may have at most " + std::to_string(kToolTrianglesMost) +
                                " triangles, got " + std::to_string(report.triangles));
  }
  if (!report.closed())
    throw std::invalid_argument(mesh.name() + ": a tool's mesh must be closed, got " + to_text(report));
  const double box_m3 = mesh.box_m().volume();
  if (!(report.volume_m3 > 1e-9 * box_m3)) {
    throw std::invalid_argument(mesh.name() + ": a tool's mesh must enclose a volume, got " +
                                text::to_text(report.volume_m3) + " m^3");
  }
}

std::vector<ToolPoint> points_of_mesh(const TriangleMesh& mesh, double spacing_m) {
  check_mesh(mesh);
  Spaced points(0.5 * spacing_m, spacing_m);
  for (const Point& vertex_m : mesh.vertices_m()) points.add(mesh.origin_m() + vertex_m);
  for (const bool inside : {false, true}) {
    for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
      const Point& a = mesh.corner_m(i, 0);
      const Point ab = mesh.corner_m(i, 1) - a;
      const Point ac = mesh.corner_m(i, 2) - a;
      const double n = intervals(std::max({ab.norm(), ac.norm(), (ac - ab).norm()}), spacing_m);
      // Half a square of the grid for each point: no more than the surface has room for.
      refuse_too_many(0.25 * n * n * std::min(1.0, ab.cross(ac).norm() / (spacing_m * spacing_m * n * n)), spacing_m);
      for (double u = 0; u <= n; ++u) {
        for (double v = 0; u + v <= n; ++v) {
          if ((u > 0 && v > 0 && u + v < n) == inside) points.add(mesh.origin_m() + a + u / n * ab + v / n * ac);
        }
      }
    }
  }
  return points.take();
}

}  // namespace

std::span<const std::string_view> tool_part_kinds() noexcept { return kKinds; }

std::vector<ToolPoint> points_of_part(std::string_view kind, const config::Values& values,
                                      const ShapeGeometry& geometry, double spacing_m) {
  if (kind == "sphere") return {{values.point("center_m"), values.number("radius_m")}};
  if (kind == "box") return points_of_box(values.point("center_m"), values.point("size_m"), spacing_m);
  if (kind == "mesh" && geometry.mesh) return points_of_mesh(*geometry.mesh, spacing_m);
  if (kind == "capsule" || kind == "cylinder") {
    check_straight(values);
    return (kind == "capsule" ? points_of_capsule : points_of_cylinder)(values.point("from_m"), values.point("to_m"),
                                                                        values.number("radius_m"), spacing_m);
  }
  throw std::invalid_argument(
      "a part of a tool must be one of: " + text::join(std::vector<std::string>(kKinds.begin(), kKinds.end())) +
      ", got '" + std::string(kind) + "'");
}

}  // namespace forcebound::scene
