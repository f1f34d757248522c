#include "forcebound/handover/scene_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "forcebound/handover/coarse_level.hpp"
#include "forcebound/handover/internal/geometry_assembly.hpp"
#include "forcebound/handover/internal/part_maker.hpp"
#include "forcebound/handover/internal/proto_values.hpp"
#include "forcebound/handover/internal/two_levels.hpp"
#include "forcebound/scene/cost.hpp"
#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/scene/part.hpp"
#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/tissue/tissue_shape.hpp"

namespace forcebound::handover {
namespace {

// In the time of a triangle or height: cells, and bytes of a shape without geometry.
constexpr std::size_t kCoverageCells = 3;
constexpr std::size_t kShapeBytes = 64;

/// A shape of which the geometry is not there yet: nothing to touch, and nothing is known about it.
class NotThereYet final : public scene::Shape {
 public:
  scene::SurfacePoint nearest(const Point&, std::byte*) const noexcept override {
    return {.penetration_m = -std::numeric_limits<double>::max()};
  }
};

/// One shape in several scenes, of which each owns its shapes.
class SharedShape final : public scene::Shape {
 public:
  explicit SharedShape(std::shared_ptr<const scene::Shape> shape) : shape_(std::move(shape)) {}

  scene::SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override {
    return shape_->nearest(position_m, state);
  }
  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return shape_->is_clear_of(center_m, radius_m);
  }
  scene::ShapeFacts facts() const override { return shape_->facts(); }
  scene::ShapeGeometry geometry() const override { return shape_->geometry(); }
  void begin_outside(const Point& free_m, std::byte* state) const noexcept override {
    shape_->begin_outside(free_m, state);
  }

 private:
  std::shared_ptr<const scene::Shape> shape_;
};

/// @throws HandoverError if it is none
std::shared_ptr<const scene::Tool> tool_of(const v1::SceneTool& from) try {
  constexpr int kNumbers = 4;
  if (from.point_size() % kNumbers != 0)
    throw HandoverError("a tool's points have " + std::to_string(from.point_size()) + " numbers, not 4 each");
  std::vector<scene::ToolPoint> points;
  for (int i = 0; i < from.point_size(); i += kNumbers)
    points.push_back({Point(from.point(i), from.point(i + 1), from.point(i + 2)), from.point(i + 3)});
  const auto contact = from.by_penalty() ? scene::ToolContact::penalty : scene::ToolContact::constraint;
  std::vector<scene::ToolPart> parts;
  for (const v1::ToolPart& part : from.part()) {
    if (!v1::ToolPart::Kind_IsValid(part.kind()))
      throw HandoverError("a part of a tool is a capsule, cylinder or box, got kind " + std::to_string(part.kind()));
    parts.push_back({.kind = static_cast<scene::ToolPart::Kind>(part.kind()),
                     .from_m = point_of(part.from()),
                     .to_m = point_of(part.to()),
                     .radius_m = part.radius()});
  }
  return std::make_shared<const scene::Tool>(std::move(points), contact, std::move(parts));
} catch (const std::invalid_argument& error) {
  throw HandoverError(error.what());
}

}  // namespace

struct SceneAssembly::Parts {
  /// A shape, and what it was built of.
  struct Built {
    std::shared_ptr<const scene::Shape> shape{};  // null: there is none yet
    GeometryAssembly::Made made{};
  };

  /// What was built last of an object, and of how much of its geometry.
  struct BuiltObject {
    Built coarse{};
    Built full{};
    std::size_t pieces = 0;
    Coverage coverage = Coverage::nothing();

    [[nodiscard]] std::size_t memory_bytes() const {
      return (coarse.shape ? coarse.shape->facts().memory_bytes : 0) +
             (full.shape ? full.shape->facts().memory_bytes : 0);
    }
    [[nodiscard]] std::size_t in_fullest_places() const {
      return coarse.made.in_fullest_place + full.made.in_fullest_place;
    }
  };

  Announcement announcement;
  scene::Registry registry;
  Limits limits;
  std::vector<std::byte> manifest_bytes;
  std::vector<bool> here;  // of all pieces
  std::size_t pieces_here = 0;
  std::optional<v1::SceneManifest> manifest{};
  std::shared_ptr<const scene::Tool> tool{};  // of the manifest
  std::vector<GeometryAssembly> geometries{};
  std::vector<BuiltObject> built{};                       // of the objects
  std::map<std::size_t, std::vector<std::byte>> early{};  // pieces that overtook their hash

  [[nodiscard]] std::size_t of_manifest() const { return handover::manifest_pieces(announcement.manifest_bytes); }

  void add_manifest_piece(std::size_t number, std::span<const std::byte> bytes);
  void read_manifest();
  void add_geometry_piece(std::size_t number, std::span<const std::byte> bytes);
  [[nodiscard]] Eigen::Index axes() const { return std::max(1, manifest->degrees_of_freedom()); }
  void check_bytes() const;
  void check_work(const scene::Scene& scene) const;
  scene::SceneObject make_object(std::size_t number, AssembledScene& made);
  [[nodiscard]] const GeometryAssembly* coarse_of(std::size_t geometry) const;
  [[nodiscard]] Built build_shape(scene::SceneObject& object, const GeometryAssembly& geometry, AssembledScene& made);
  void give_shape(scene::SceneObject& object, std::size_t number, std::size_t geometry_number, AssembledScene& made);
};

SceneAssembly::SceneAssembly(const Announcement& announcement, scene::Registry registry, const Limits& limits) {
  const auto over = [](const std::string& what, std::size_t got, std::size_t most) {
    throw HandoverError("the server announces " + std::to_string(got) + " " + what + ", at most " +
                        std::to_string(most) + " are taken");
  };
  if (announcement.manifest_bytes > limits.manifest_bytes)
    over("bytes of manifest", announcement.manifest_bytes, limits.manifest_bytes);
  if (announcement.pieces > limits.pieces) over("pieces", announcement.pieces, limits.pieces);
  const std::size_t of_manifest = handover::manifest_pieces(announcement.manifest_bytes);
  if (of_manifest == 0 || announcement.pieces < of_manifest)
    throw HandoverError("the server announces fewer pieces than its manifest has");
  parts_ = std::make_unique<Parts>(Parts{.announcement = announcement,
                                         .registry = std::move(registry),
                                         .limits = limits,
                                         .manifest_bytes = std::vector<std::byte>(announcement.manifest_bytes),
                                         .here = std::vector<bool>(announcement.pieces)});
  if (parts_->registry.find_shape("tissue") == nullptr) parts_->registry.add(tissue::tissue_shape());
}

SceneAssembly::~SceneAssembly() = default;
SceneAssembly::SceneAssembly(SceneAssembly&&) noexcept = default;
SceneAssembly& SceneAssembly::operator=(SceneAssembly&&) noexcept = default;

const Announcement& SceneAssembly::announcement() const noexcept { return parts_->announcement; }
std::size_t SceneAssembly::pieces_here() const noexcept { return parts_->pieces_here; }
bool SceneAssembly::can_build() const noexcept { return parts_->manifest.has_value(); }

void SceneAssembly::add(std::size_t number, std::span<const std::byte> bytes) {
  Parts& p = *parts_;
  if (number >= p.here.size()) {
    throw HandoverError("piece " + std::to_string(number) + " of " + std::to_string(p.here.size()));
  }
  if (bytes.size() > kPieceBytesMax) {
    throw HandoverError("piece " + std::to_string(number) + " is " + std::to_string(bytes.size()) +
                        " bytes long, more than " + std::to_string(kPieceBytesMax));
  }
  if (p.here[number]) return;
  if (number < p.of_manifest()) {
    p.add_manifest_piece(number, bytes);
  } else {
    p.add_geometry_piece(number, bytes);
  }
}

void SceneAssembly::Parts::add_manifest_piece(std::size_t number, std::span<const std::byte> bytes) {
  const std::size_t begin = number * kPieceBytesMax;
  if (bytes.size() != std::min(kPieceBytesMax, manifest_bytes.size() - begin))
    throw HandoverError("a piece of the manifest has " + std::to_string(bytes.size()) + " bytes");
  std::ranges::copy(bytes, manifest_bytes.begin() + static_cast<std::ptrdiff_t>(begin));
  here[number] = true;
  ++pieces_here;
  const auto last = here.begin() + static_cast<std::ptrdiff_t>(of_manifest());
  if (std::find(here.begin(), last, false) == last) read_manifest();
}

void SceneAssembly::Parts::read_manifest() {
  if (hash_of(manifest_bytes) != announcement.hash)
    throw HandoverError("the manifest is not that of the announced hash");
  v1::SceneManifest read;
  if (!read.ParseFromArray(manifest_bytes.data(), static_cast<int>(manifest_bytes.size())))
    throw HandoverError("the manifest cannot be read");
  check_manifest(read, limits);
  std::size_t pieces = of_manifest();
  std::size_t triangles = 0;
  std::size_t heights = 0;
  for (const v1::Geometry& geometry : read.geometries()) {
    triangles += geometry.triangles();
    heights += std::size_t{geometry.columns()} * geometry.rows();
    if (triangles > limits.triangles || heights > limits.heights) {
      throw HandoverError("the scene has more geometry than is taken: at most " + std::to_string(limits.triangles) +
                          " triangles and " + std::to_string(limits.heights) + " heights");
    }
    geometries.emplace_back(geometry, pieces);
    pieces += geometries.back().pieces();
  }
  if (pieces != announcement.pieces) throw HandoverError("the manifest has other pieces than were announced");
  built.resize(static_cast<std::size_t>(read.objects_size()));
  if (read.has_tool()) tool = tool_of(read.tool());
  manifest = std::move(read);
  for (const auto& [number, bytes] : std::exchange(early, {})) add_geometry_piece(number, bytes);
}

void SceneAssembly::Parts::add_geometry_piece(std::size_t number, std::span<const std::byte> bytes) {
  if (here[number]) return;
  // The end if there is no manifest yet.
  const auto of = std::ranges::find_if(
      geometries, [number](const GeometryAssembly& geometry) { return number < geometry.first() + geometry.pieces(); });
  if (of == geometries.end() || !of->knows_hash_of(number)) {
    // The server sends the manifest and lists first; no more than a network's worth of pieces overtakes them.
    constexpr std::size_t kEarlyMax = 4096;
    early.try_emplace(number, bytes.begin(), bytes.end());
    if (early.size() > kEarlyMax) throw HandoverError("the server sends geometry without its hashes");
    return;
  }
  of->add(number, bytes);
  here[number] = true;
  ++pieces_here;
  const GeometryAssembly::Listed listed = of->listed_by(number);
  for (auto next = early.lower_bound(listed.first); next != early.end() && next->first < listed.end;) {
    const auto overtook = early.extract(next++);
    add_geometry_piece(overtook.key(), overtook.mapped());
  }
}

std::size_t SceneAssembly::coarse_levels_here() const noexcept {
  return static_cast<std::size_t>(std::ranges::count_if(parts_->geometries, [](const GeometryAssembly& geometry) {
    return geometry.coarse_of() != 0 && geometry.whole();
  }));
}

double SceneAssembly::known_within_m(const Point& point_m) const {
  if (!can_build()) return 0;
  double least_m = std::numeric_limits<double>::infinity();
  for (const GeometryAssembly& geometry : parts_->geometries) {
    if (geometry.coarse_of() == 0) least_m = std::min(least_m, geometry.known_within_m(point_m));
  }
  return least_m;
}

scene::SceneObject SceneAssembly::Parts::make_object(std::size_t number, AssembledScene& made) {
  const v1::ScenePart& part = manifest->objects(static_cast<int>(number));
  const scene::ShapeKind& kind = scene::shape_kind(registry, part.shape(), axes());
  // Without its geometry, a shape would be made of a file of this machine.
  const bool has_geometry = part.geometry() != 0;
  if ((kind.geometry != scene::GeometryKind::none) != has_geometry) {
    throw HandoverError("object '" + one_line(part.name()) + "': a " + part.shape() + " " +
                        (has_geometry ? "has no geometry" : "needs a geometry"));
  }
  made.coverage.emplace_back();
  made.exact.emplace_back();
  scene::SceneObject object = without_shape(part, true, registry, axes());
  object.tool_reach_m = tool ? tool->reach_of_points_m() : 0;
  if (has_geometry) {
    give_shape(object, number, part.geometry() - 1, made);
  } else {
    // Tissue takes seconds.
    Built& last = built[number].full;
    if (!last.shape) {
      set_shape(object, kind, object.shape_values, axes(), {});
      last.shape = std::move(object.shape);
      made.elements_built += last.shape->facts().memory_bytes / kShapeBytes;
      check_bytes();
      if (scene::SearchBudget::abandoned()) throw HandoverError("nobody waits for the scene any more");
    }
    object.shape = std::make_unique<SharedShape>(last.shape);
  }
  return object;
}

/// Null: it has no coarse level.
const GeometryAssembly* SceneAssembly::Parts::coarse_of(std::size_t geometry) const {
  const auto found = std::ranges::find(geometries, geometry + 1, &GeometryAssembly::coarse_of);
  return found == geometries.end() ? nullptr : &*found;
}

SceneAssembly::Parts::Built SceneAssembly::Parts::build_shape(scene::SceneObject& object,
                                                              const GeometryAssembly& geometry, AssembledScene& made) {
  Built one{.made = geometry.made(limits)};
  if (scene::SearchBudget::abandoned()) throw HandoverError("nobody waits for the scene any more");
  const scene::ShapeGeometry& so_far = one.made.geometry;
  made.elements_built += so_far.mesh ? so_far.mesh->triangles().size() : so_far.heights->heights_m.size();
  set_shape(object, scene::shape_kind(registry, object.shape_kind, axes()), object.shape_values, axes(), {}, so_far);
  one.shape = std::move(object.shape);
  return one;
}

void SceneAssembly::Parts::give_shape(scene::SceneObject& object, std::size_t number, std::size_t geometry_number,
                                      AssembledScene& made) {
  const GeometryAssembly& geometry = geometries[geometry_number];
  const GeometryAssembly* const coarse = coarse_of(geometry_number);
  BuiltObject& last = built[number];
  if (coarse != nullptr && coarse->whole() && !last.coarse.shape) last.coarse = build_shape(object, *coarse, made);
  // A distance field is made of all of its mesh. And nothing is felt before its coarse level is there, for which there
  // has to be a place in its state.
  const bool usable = geometry.here() > 0 && (geometry.whole() || object.shape_kind != "distance_field") &&
                      (coarse == nullptr || last.coarse.shape);
  if (usable && last.pieces != geometry.here()) {
    last.full = build_shape(object, geometry, made);
    last.pieces = geometry.here();
    last.coverage = geometry.coverage();
    made.elements_built += last.coverage.cells() / kCoverageCells;
    if (coarse != nullptr)
      check_error(*last.coarse.made.geometry.tree, coarse->error_m(), *last.full.made.geometry.tree, geometry.whole());
    last.full.made.geometry = {};
  }
  check_bytes();
  made.exact.back() = last.coverage;
  if (last.coarse.shape) {
    double reach_m = object.tool_reach_m;
    for (const scene::RequestedEffect& effect : object.effects)
      reach_m = std::max(reach_m, effect.effect->facts().reach_m);
    object.shape =
        std::make_unique<TwoLevels>(TwoLevels::Coarse{.shape = last.coarse.shape, .error_m = coarse->error_m()},
                                    TwoLevels::Full{.shape = last.full.shape, .known = last.coverage}, reach_m);
    return;
  }
  made.coverage.back() = last.coverage;
  if (last.full.shape) {
    object.shape = std::make_unique<SharedShape>(last.full.shape);
  } else {
    object.shape = std::make_unique<NotThereYet>();
  }
}

void SceneAssembly::Parts::check_bytes() const {
  std::size_t bytes = 0;
  for (const BuiltObject& one : built) bytes += one.memory_bytes();
  if (bytes > limits.shape_bytes) {
    throw HandoverError("the scene's shapes take " + std::to_string(bytes) + " bytes, at most " +
                        std::to_string(limits.shape_bytes) + " are accepted");
  }
}

/// Each limit may be kept, and still all of them together take a tick too long.
void SceneAssembly::Parts::check_work(const scene::Scene& scene) const {
  constexpr double kTriangleInPlace_ns = 20;
  double work_ns = scene::predicted_cost_ns(scene);
  for (const BuiltObject& one : built) work_ns += kTriangleInPlace_ns * static_cast<double>(one.in_fullest_places());
  if (work_ns <= limits.tick_ns) return;
  throw HandoverError("the scene would take about " + std::to_string(std::lround(1e-3 * work_ns)) +
                      " us of each tick, at most " + std::to_string(std::lround(1e-3 * limits.tick_ns)) +
                      " are accepted");
}

AssembledScene SceneAssembly::build(const std::stop_token& ended) try {
  Parts& p = *parts_;
  const scene::SearchBudget budget(p.limits.nodes_of_a_build, &ended);
  AssembledScene made;
  made.whole = whole();
  scene::SceneFacts facts{.name = one_line(p.manifest->name()),
                          .description = {},
                          .degrees_of_freedom = p.manifest->degrees_of_freedom(),
                          .tool = p.tool};
  scene::SceneParts parts;
  for (int i = 0; i < p.manifest->objects_size(); ++i) {
    parts.objects.push_back(p.make_object(static_cast<std::size_t>(i), made));
  }
  for (const v1::ScenePart& field : p.manifest->fields()) {
    parts.fields.push_back(without_shape(field, false, p.registry, p.axes()));
    made.coverage.emplace_back();
    made.exact.emplace_back();
  }
  made.scene = std::make_shared<const scene::Scene>(std::move(facts), std::move(parts));
  p.check_work(*made.scene);
  if (ended.stop_requested()) throw HandoverError("nobody waits for the scene any more");
  return made;
} catch (const HandoverError&) {
  throw;
} catch (const std::exception& error) {
  throw HandoverError(one_line(error.what()));
}

void SceneAssembly::add_content(std::span<const std::byte> content) {
  const auto next = [&content](std::size_t bytes) {
    if (bytes > content.size()) throw HandoverError("the content ends too early");
    const auto begin = content.first(bytes);
    content = content.subspan(bytes);
    return begin;
  };
  const std::size_t of_manifest = parts_->of_manifest();
  for (std::size_t i = 0, left = announcement().manifest_bytes; i < of_manifest; ++i) {
    const auto piece = next(std::min(left, kPieceBytesMax));
    left -= piece.size();
    add(i, piece);
  }
  for (std::size_t i = of_manifest; i < announcement().pieces; ++i) {
    const auto length = next(2);
    add(i, next(std::to_integer<std::size_t>(length[0]) + 256 * std::to_integer<std::size_t>(length[1])));
  }
  if (!content.empty()) throw HandoverError("the content goes on after its end");
}

std::vector<std::byte> SceneAssembly::content() const {
  std::vector<std::byte> all = parts_->manifest_bytes;
  for (const GeometryAssembly& geometry : parts_->geometries) geometry.append_content(all);
  return all;
}

std::string why_refused(const scene::Scene& scene, const Limits& limits) try {
  const std::shared_ptr<const PackedScene> packed = pack(scene);
  if (!packed) return {};
  SceneAssembly assembly(packed->announcement(), scene::Registry::standard(), limits);
  for (std::size_t i = 0; i < packed->announcement().pieces; ++i) assembly.add(i, packed->piece(i));
  (void)assembly.build();
  return {};
} catch (const std::exception& error) {
  return one_line(error.what());
}

}  // namespace forcebound::handover
