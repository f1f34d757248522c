#include "forcebound/scene/geometry/distance_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/geometry/last_normal.hpp"
#include "forcebound/scene/geometry/mesh_shape.hpp"
#include "forcebound/scene/geometry/pseudonormals.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

constexpr double kNodesMost = 1 << 22;
// Cubic interpolation needs one node more on each side of the cell; another step keeps the surface off the rim.
constexpr double kRimSteps = 2;
// A distance has a gradient of length 1. Where it is much shorter, opposite surfaces cancel.
constexpr double kGradientLeast = 1e-3;

/// Weights of four nodes at a share t of the way from the second to the third, and their derivatives by t.
struct Cubic {
  explicit Cubic(double t) noexcept
      : value{0.5 * t * (-1 + t * (2 - t)), 0.5 * (2 + t * t * (3 * t - 5)), 0.5 * t * (1 + t * (4 - 3 * t)),
              0.5 * t * t * (t - 1)},
        slope{0.5 * (-1 + t * (4 - 3 * t)), 0.5 * t * (9 * t - 10), 0.5 * (1 + t * (8 - 9 * t)),
              0.5 * t * (3 * t - 2)} {}
  std::array<double, 4> value;
  std::array<double, 4> slope;
};

/// The tree, if it is of that mesh; else one that is built.
std::shared_ptr<const Bvh> tree_of(const std::shared_ptr<const TriangleMesh>& mesh,
                                   const std::shared_ptr<const Bvh>& tree) {
  const bool fits = tree != nullptr && &tree->mesh() == mesh.get();
  return fits ? tree : std::make_shared<const Bvh>(mesh);
}

class DistanceField final : public Shape {
 public:
  DistanceField(const std::shared_ptr<const TriangleMesh>& mesh, const DistanceFieldOptions& options)
      : mesh_(mesh),
        origin_m_(mesh->origin_m()),
        low_m_(mesh->box_m().min().array() - (options.reach_m + kRimSteps * options.spacing_m)),
        spacing_m_(options.spacing_m),
        beyond_m_(std::max(options.reach_m, options.spacing_m)),
        bounds_m_(mesh->box_m().translated(origin_m_)),
        text_("that is " + to_text(mesh->report())) {
    const Point steps = ((mesh->box_m().max() - low_m_).array() + options.reach_m) / spacing_m_ + kRimSteps;
    const Point nodes = steps.array().ceil() + 1;
    if (!(nodes.prod() <= kNodesMost)) {
      throw GeometryError(mesh->name() + ": spacing_m " + text::to_text(spacing_m_) + " would need " +
                          text::rounded(nodes.prod()) + " grid nodes, more than " + text::to_text(kNodesMost));
    }
    nodes_ = nodes.cast<Eigen::Index>();
    fill(*tree_of(mesh, options.tree), Pseudonormals(*mesh));
  }

  SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override {
    const Point at = (position_m - origin_m_ - low_m_) / spacing_m_;
    const Point most = (nodes_.array() - 2).cast<double>();
    if (!((at.array() >= 1) && (at.array() <= most.array())).all()) return {.penetration_m = -beyond_m_};
    const Eigen::Array<Eigen::Index, 3, 1> cell = at.array().floor().cast<Eigen::Index>().min(nodes_.array() - 3);
    const Point share = at.array() - cell.cast<double>();
    const Cubic x(share.x());
    const Cubic y(share.y());
    const Cubic z(share.z());
    double phi_m = 0;
    Point gradient = Point::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t j = 0; j < 4; ++j) {
        const double* const row = &phi_m_[index(cell.x() - 1, cell.y() - 1 + static_cast<Eigen::Index>(j),
                                                cell.z() - 1 + static_cast<Eigen::Index>(k))];
        double value = 0;
        double slope = 0;
        for (std::size_t i = 0; i < 4; ++i) {
          value += x.value[i] * row[i];
          slope += x.slope[i] * row[i];
        }
        phi_m += y.value[j] * z.value[k] * value;
        gradient +=
            Point(y.value[j] * z.value[k] * slope, y.slope[j] * z.value[k] * value, y.value[j] * z.slope[k] * value);
      }
    }
    gradient /= spacing_m_;
    return LastNormal::in(state).along(gradient, gradient.norm(), kGradientLeast, -phi_m);
  }

  /// Cubic convolution is off by less than a step of the grid.
  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return bounds_m_.exteriorDistance(center_m) > radius_m ||
           is_clear_by_nearest(*this, center_m, radius_m + spacing_m_);
  }

  ShapeFacts facts() const override {
    return {.state_bytes = sizeof(LastNormal),
            .memory_bytes = sizeof *this + phi_m_.size() * sizeof(double) + mesh_->memory_bytes(),
            .cost_ns = 120,
            .bounds_m = bounds_m_,
            .text = text_};
  }

  ShapeGeometry geometry() const override { return {.mesh = mesh_}; }

 private:
  [[nodiscard]] std::size_t index(Eigen::Index i, Eigen::Index j, Eigen::Index k) const noexcept {
    return static_cast<std::size_t>(i + nodes_.x() * (j + nodes_.y() * k));
  }

  void fill(const Bvh& bvh, const Pseudonormals& sides) {
    phi_m_.reserve(static_cast<std::size_t>(nodes_.prod()));
    for (Eigen::Index k = 0; k < nodes_.z(); ++k) {
      for (Eigen::Index j = 0; j < nodes_.y(); ++j) {
        double within_m = std::numeric_limits<double>::infinity();
        for (Eigen::Index i = 0; i < nodes_.x(); ++i) {
          const Point node =
              low_m_ + spacing_m_ * Point(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
          // The surface is at most one step farther than from the node before.
          const auto found = bvh.nearest(node, within_m);
          if (!found || SearchBudget::abandoned())
            throw GeometryError(mesh_->name() + ": its distances take too long to find");
          within_m = 1.001 * (found->distance_m + spacing_m_);
          phi_m_.push_back(sides.is_inside(node, *found) ? -found->distance_m : found->distance_m);
        }
      }
    }
  }

  std::shared_ptr<const TriangleMesh> mesh_;
  Point origin_m_;
  Point low_m_;  // of the grid, in the mesh's own frame
  double spacing_m_;
  double beyond_m_;
  Eigen::AlignedBox3d bounds_m_;  // of the mesh
  std::string text_;
  Eigen::Matrix<Eigen::Index, 3, 1> nodes_;
  std::vector<double> phi_m_;
};

}  // namespace

std::unique_ptr<Shape> make_distance_field(std::shared_ptr<const TriangleMesh> mesh,
                                           const DistanceFieldOptions& options) {
  const auto refuse = [&](const std::string& what) { throw GeometryError(mesh->name() + ": " + what); };
  if (!(options.spacing_m > 0) || !std::isfinite(options.spacing_m)) {
    refuse("spacing_m must be > 0, got " + text::to_text(options.spacing_m));
  }
  if (!(options.reach_m >= 0) || !std::isfinite(options.reach_m)) {
    refuse("reach_m must be >= 0, got " + text::to_text(options.reach_m));
  }
  if (mesh->report().closed() && mesh->report().volume_m3 < 0) refuse("is inside out: its triangles face inwards");
  return std::make_unique<DistanceField>(mesh, options);
}

ShapeKind distance_field_shape() {
  return {.name = "distance_field",
          .description =
              "A closed mesh as its signed distance on a grid: edges are rounded by about a grid step, and "
              "the cost does not depend on the mesh; 3 axes.",
          .axes_least = 3,
          .geometry = GeometryKind::triangles,
          .parameters = mesh_parameters({positive_length("spacing_m", "of the grid")}),
          .source = "file",
          .make = [](const config::Values& values, const ShapePurpose& purpose) {
            return make_distance_field(
                given_mesh(purpose),
                {.spacing_m = values.number("spacing_m"), .reach_m = purpose.reach_m, .tree = purpose.geometry.tree});
          }};
}

}  // namespace forcebound::scene
