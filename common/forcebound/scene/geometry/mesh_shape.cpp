#include "forcebound/scene/geometry/mesh_shape.hpp"

#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "forcebound/scene/geometry/god_object.hpp"
#include "forcebound/scene/geometry/pseudonormals.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

// Who begins beside a part of a mesh knows all of it so far about.
constexpr double kPartKnown_m = 1e-3;

class MeshShape final : public Shape {
 public:
  MeshShape(std::shared_ptr<const TriangleMesh> mesh, const MeshShapeOptions& options)
      : mesh_(std::move(mesh)),
        object_(options.tree && &options.tree->mesh() == mesh_.get() ? Bvh(*options.tree) : Bvh(mesh_),
                {.two_sided = options.two_sided}),
        reach_m_(options.reach_m) {
    if (this->mesh().report().closed() && !options.two_sided) sides_.emplace(this->mesh());
  }

  SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override {
    Proxy& proxy = *std::launder(reinterpret_cast<Proxy*>(state));
    if (proxy.placed == 0) put_to_the_surface(position_m, proxy);
    const SurfacePoint held = object_.follow(position_m, proxy);
    if (held.penetration_m > 0 || reach_m_ == 0) return held;
    const Point local_m = position_m - mesh().origin_m();
    const auto found = object_.bvh().nearest(local_m, reach_m_);
    if (!found || !(found->distance_m > 0)) return {.normal = held.normal, .penetration_m = found ? 0 : -reach_m_};
    return {.normal = (local_m - found->point_m) / found->distance_m, .penetration_m = -found->distance_m};
  }

  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    const Point local_m = center_m - mesh().origin_m();
    // Of a part of a mesh that lies beside it may be missing.
    if (mesh().triangles().size() < mesh().report().triangles) return false;
    if (mesh().box_m().exteriorDistance(local_m) > radius_m) return !(mesh().report().volume_m3 < 0);
    const auto found = object_.bvh().nearest(local_m);
    return found && found->distance_m > radius_m && !(sides_ && sides_->is_inside(local_m, *found));
  }

  ShapeFacts facts() const override {
    // The cost of searches grows with the depth of the tree.
    constexpr double kPerLevel_ns = 45;
    const double levels = std::log2(static_cast<double>(mesh().triangles().size()) + 1);
    return {.state_bytes = sizeof(Proxy),
            .memory_bytes = sizeof *this + object_.memory_bytes() + (sides_ ? sides_->memory_bytes() : 0),
            .cost_ns = (reach_m_ > 0 ? 2 : 1) * kPerLevel_ns * levels,
            .on_surface_m = top_m(),
            .bounds_m = mesh().box_m().translated(mesh().origin_m()),
            .text = "that is " + to_text(mesh().report())};
  }

  ShapeGeometry geometry() const override { return {.mesh = mesh_}; }

  void begin_outside(const Point& free_m, std::byte* state) const noexcept override {
    const Point local_m = free_m - mesh().origin_m();
    if (!local_m.allFinite()) return;
    Proxy& proxy = *std::launder(reinterpret_cast<Proxy*>(state));
    put_to_the_surface(free_m, proxy);
    if (proxy.placed == 0) proxy = proxy_at(local_m, local_m);
  }

 private:
  [[nodiscard]] const TriangleMesh& mesh() const noexcept { return *mesh_; }

  /// The centre of the highest triangle: a device that comes from above meets the mesh there.
  [[nodiscard]] Point top_m() const {
    Point top = Point::Constant(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < mesh().triangles().size(); ++i) {
      const Point middle = (mesh().corner_m(i, 0) + mesh().corner_m(i, 1) + mesh().corner_m(i, 2)) / 3;
      if (middle.z() > top.z()) top = middle;
    }
    return mesh().origin_m() + top;
  }

  void put_to_the_surface(const Point& position_m, Proxy& proxy) const noexcept {
    if (!sides_ || !position_m.allFinite()) return;
    const Point local_m = position_m - mesh().origin_m();
    if (mesh().report().volume_m3 > 0 && !mesh().box_m().contains(local_m)) return;
    // What is further from a part tells no sides: what lies beside it may be missing.
    const bool part = mesh().triangles().size() < mesh().report().triangles;
    const auto found = object_.bvh().nearest(local_m, part ? kPartKnown_m : std::numeric_limits<double>::infinity());
    if (found && sides_->is_inside(local_m, *found)) {
      proxy = proxy_at(found->point_m, local_m);
    }
  }

  std::shared_ptr<const TriangleMesh> mesh_;
  GodObject object_;
  std::optional<Pseudonormals> sides_;  // of a closed mesh
  double reach_m_;
};

}  // namespace

std::unique_ptr<Shape> make_mesh(std::shared_ptr<const TriangleMesh> mesh, const MeshShapeOptions& options) {
  if (!(options.reach_m >= 0) || !std::isfinite(options.reach_m)) {
    throw GeometryError(mesh->name() + ": reach_m must be >= 0, got " + text::to_text(options.reach_m));
  }
  return std::make_unique<MeshShape>(std::move(mesh), options);
}

std::vector<config::Parameter> mesh_parameters(const std::vector<config::Parameter>& own) {
  std::vector<config::Parameter> all{
      config::TextParameter{.key = "file", .meaning = "OBJ, STL or OFF", .form = config::TextParameter::Form::file}};
  for (const config::Parameter& parameter : placement_parameters()) all.push_back(parameter);
  all.emplace_back(
      config::positive_number("detail", "share of the triangles to keep; below 1 of closed meshes only", 1, 1));
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

const std::shared_ptr<const TriangleMesh>& given_mesh(const ShapePurpose& purpose) {
  if (!purpose.geometry.mesh) throw std::invalid_argument("a shape of a mesh file needs the file's triangles");
  return purpose.geometry.mesh;
}

ShapeKind mesh_shape() {
  return {.name = "mesh",
          .description = "Triangles from a file, felt through a god object; 3 axes.",
          .axes_least = 3,
          .geometry = GeometryKind::triangles,
          .parameters = mesh_parameters(
              {config::FlagParameter{.key = "two_sided", .meaning = "whether it is felt from behind as well"}}),
          .source = "file",
          .make = [](const config::Values& values, const ShapePurpose& purpose) {
            return make_mesh(
                given_mesh(purpose),
                {.two_sided = values.flag("two_sided"), .reach_m = purpose.reach_m, .tree = purpose.geometry.tree});
          }};
}

}  // namespace forcebound::scene
