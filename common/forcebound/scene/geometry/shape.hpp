#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/config/parameter.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/scene/geometry/surface_point.hpp"

namespace forcebound::scene {

class Bvh;
class TriangleMesh;
struct HeightGrid;

/// Facts of a shape, for the plan and for `--explain`.
struct ShapeFacts {
  std::size_t state_bytes = 0;         ///< kept for each session, zeros at first
  std::size_t memory_bytes = 0;        ///< of the shape itself, shared by all sessions
  double cost_ns = 5;                  ///< estimate for one motion
  Point on_surface_m = Point::Zero();  ///< a point of the surface, for calibration
  Eigen::AlignedBox3d bounds_m{};      ///< of the finite parts of the surface; may be empty
  std::string text{};                  ///< one line for `--explain`; empty: its values are enough
};

/// What a kind of shape is made of beside its values. Triangles are those of the file that its values name.
enum class GeometryKind : std::uint8_t { none, triangles, heights };

/// The triangles or heights of a shape. With its values they make the same shape again where its files are not.
struct ShapeGeometry {
  std::shared_ptr<const TriangleMesh> mesh{};
  std::shared_ptr<const HeightGrid> heights{};
  std::shared_ptr<const Bvh> tree{};  ///< of the mesh, if there is one already; else who needs one builds it

  [[nodiscard]] GeometryKind kind() const noexcept {
    if (mesh) return GeometryKind::triangles;
    return heights ? GeometryKind::heights : GeometryKind::none;
  }
};

/// The box around a point, `half_m` to each side.
[[nodiscard]] inline Eigen::AlignedBox3d bounds_about(const Point& middle_m, const Point& half_m) {
  return {Point(middle_m - half_m), Point(middle_m + half_m)};
}

/// The solid of an object.
///
/// Real time: `nearest` is noexcept, allocates nothing and takes bounded time. Immutable; its memory of a client lies
/// in `state`, ShapeFacts::state_bytes long, aligned for a double.
class Shape {
 public:
  virtual ~Shape() = default;

  [[nodiscard]] virtual SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept = 0;

  /// Whether a ball has no point in the solid, as far as that can be told without its state; false: it may have. Of a
  /// solid that `nearest` takes for a surface, as an open mesh, the surface counts. Real time, as `nearest`.
  [[nodiscard]] virtual bool is_clear_of(const Point& center_m, double radius_m) const noexcept {
    (void)center_m;
    (void)radius_m;
    return false;
  }

  [[nodiscard]] virtual ShapeFacts facts() const { return {}; }

  /// What it is made of, of its kind's `geometry`. Allocates.
  [[nodiscard]] virtual ShapeGeometry geometry() const { return {}; }

  /// Lets a fresh state begin at a point outside of the solid, instead of at the first point that `nearest` is asked
  /// about. From a point inside it begins as `nearest` would there: outside of one object may be inside of another.
  /// Real time, as the first call of `nearest`.
  virtual void begin_outside(const Point& free_m, std::byte* state) const noexcept {
    (void)free_m;
    (void)state;
  }
};

/// Shape::is_clear_of where `nearest` gives the distance outside of the solid, and a fresh state is a LastNormal's.
[[nodiscard]] bool is_clear_by_nearest(const Shape& shape, const Point& center_m, double radius_m) noexcept;

/// Inputs for making a shape, beside its values.
struct ShapePurpose {
  double reach_m = 0;    ///< distances up to this far outside are needed; 0: contact only
  std::string folder{};  ///< paths among its values are relative to it
  /// Of the kind's `geometry`. Triangles must be given; heights replace those of the values.
  ShapeGeometry geometry{};
};

/// A kind of shape for scene files: `kind = "NAME"`, and its keys.
struct ShapeKind {
  std::string_view name;
  std::string_view description;  ///< for the schema page, in a sentence or two
  int axes_least = 1;            ///< of the scene
  GeometryKind geometry = GeometryKind::none;
  std::vector<config::Parameter> parameters{};
  std::string_view source{};  ///< key whose line an error of `make` gets if it names none
  /// @throws config::ValueError, or another std::invalid_argument or std::runtime_error, where values that are in range
  /// do not fit each other, or a file that they name cannot be read
  std::function<std::unique_ptr<Shape>(const config::Values& values, const ShapePurpose& purpose)> make;
};

/// Most of coordinates and lengths in scene files [m]: out of any device's reach, and far from where squares overflow.
inline constexpr double kLengthMost_m = 1e3;

/// A length > 0 and <= kLengthMost_m that must be given.
[[nodiscard]] config::NumberParameter positive_length(std::string_view key, std::string_view meaning);

/// A point of the scene, each coordinate within kLengthMost_m of 0. Without a preset it must be given.
[[nodiscard]] config::PointParameter place_parameter(std::string_view key, std::string_view meaning,
                                                     const std::optional<Point>& preset = {});

/// A shape between two points, of keys `from_m`, `to_m` and `radius_m`.
using MakeStraight = std::unique_ptr<Shape> (*)(const Point& from_m, const Point& to_m, double radius_m);
[[nodiscard]] ShapeKind straight_shape(std::string_view name, std::string_view description, MakeStraight make);

/// @throws config::ValueError if `from_m` equals `to_m`
void check_straight(const config::Values& values);

ShapeKind half_space_shape();
ShapeKind sphere_shape();
ShapeKind cavity_shape();
ShapeKind box_shape();

/// Everything below the plane through a point; `normal` (any length but zero) points out of the solid.
std::unique_ptr<Shape> make_half_space(const Point& through_m, const Point& normal);

/// A filled ball; on two axes a disc.
std::unique_ptr<Shape> make_sphere(const Point& center_m, double radius_m);

/// The inside of a hollow ball (on two axes: circle): everything outside of the radius is filled.
std::unique_ptr<Shape> make_cavity(const Point& center_m, double radius_m);

/// A filled block along the axes. An axis of infinite size has no faces. Where several faces are equally near, the
/// first axis counts, and on it the positive side.
std::unique_ptr<Shape> make_box(const Point& center_m, const Point& size_m);

}  // namespace forcebound::scene
