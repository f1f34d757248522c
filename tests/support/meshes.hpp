#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::test {

using scene::Point;
using scene::Triangle;

/// Triangles as in a file.
struct Soup {
  std::vector<Point> vertices;
  std::vector<Triangle> triangles;

  [[nodiscard]] scene::TriangleMesh mesh(const std::string& name = "test.obj",
                                         const scene::MeshPlacement& placement = {}) const {
    return {name, vertices, triangles, placement};
  }

  /// Adds another one's triangles.
  Soup& add(const Soup& other) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles) triangles.push_back({first + t[0], first + t[1], first + t[2]});
    return *this;
  }

  [[nodiscard]] Soup moved(const Eigen::Isometry3d& motion) const {
    Soup copy = *this;
    for (Point& vertex : copy.vertices) vertex = motion * vertex;
    return copy;
  }

  [[nodiscard]] Soup inside_out() const {
    Soup copy = *this;
    for (Triangle& t : copy.triangles) std::swap(t[1], t[2]);
    return copy;
  }

  void add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
};

inline std::shared_ptr<const scene::TriangleMesh> shared_mesh(const Soup& soup,
                                                              const scene::MeshPlacement& placement = {}) {
  return std::make_shared<const scene::TriangleMesh>(soup.mesh("test.obj", placement));
}

/// The square [-half, half]^2 at z = 0, facing +z, as rows * rows quads.
inline Soup square(double half, std::uint32_t rows) {
  Soup soup;
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i <= rows; ++i) {
      soup.vertices.emplace_back(half * (2.0 * i / rows - 1), half * (2.0 * j / rows - 1), 0);
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * (rows + 1) + i; };
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < rows; ++i) soup.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return soup;
}

/// A ball's surface: `rows` bands from pole to pole, each of 2 * rows quads, the polar ones of triangles. It has
/// 4 rows (rows - 1) triangles.
inline Soup ball(double radius, std::uint32_t rows) {
  Soup soup;
  const std::uint32_t columns = 2 * rows;
  soup.vertices.emplace_back(0, 0, radius);
  for (std::uint32_t j = 1; j < rows; ++j) {
    const double polar = std::numbers::pi * j / rows;
    for (std::uint32_t i = 0; i < columns; ++i) {
      const double turn = 2 * std::numbers::pi * i / columns;
      soup.vertices.emplace_back(
          radius * Point(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)));
    }
  }
  soup.vertices.emplace_back(0, 0, -radius);
  const auto south = static_cast<std::uint32_t>(soup.vertices.size() - 1);
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return 1 + (j - 1) * columns + i % columns; };
  for (std::uint32_t i = 0; i < columns; ++i) {
    soup.triangles.push_back({0, at(i, 1), at(i + 1, 1)});
    for (std::uint32_t j = 1; j + 1 < rows; ++j) soup.add_quad(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
    soup.triangles.push_back({south, at(i + 1, rows - 1), at(i, rows - 1)});
  }
  return soup;
}

/// A closed block of 12 triangles around the origin.
inline Soup block(const Point& half) {
  Soup soup;
  for (int i = 0; i < 8; ++i) {
    soup.vertices.emplace_back(
        half.cwiseProduct(Point((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1)));
  }
  soup.add_quad(0, 2, 3, 1);
  soup.add_quad(4, 5, 7, 6);
  soup.add_quad(0, 1, 5, 4);
  soup.add_quad(2, 6, 7, 3);
  soup.add_quad(0, 4, 6, 2);
  soup.add_quad(1, 3, 7, 5);
  return soup;
}

/// The same with its vertices moved by up to `most` in each direction, so that it has convex, concave and saddle
/// vertices.
inline Soup rough(Soup soup, double most, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> by(-most, most);
  for (Point& vertex : soup.vertices) vertex += Point(by(random), by(random), by(random));
  return soup;
}

/// A rotation about an oblique axis, so that no result is exact by chance.
inline Eigen::Isometry3d askew(const Point& to = Point::Zero()) {
  return Eigen::Translation3d(to) * Eigen::AngleAxisd(0.7, Point(1, 2, 3).normalized());
}

}  // namespace forcebound::test
