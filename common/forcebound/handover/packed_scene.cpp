#include "forcebound/handover/packed_scene.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "forcebound/handover/coarse_level.hpp"
#include "forcebound/handover/internal/proto_values.hpp"
#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/scene/part_at_client.hpp"
#include "forcebound/scene/tool/tool.hpp"

namespace forcebound::handover {
namespace {

using Box = Eigen::AlignedBox3d;
using scene::Point;

struct Cut {
  std::string bytes;
  Box where_m;
  bool comes_first = false;
};

static_assert(v1::ToolPart::CAPSULE == static_cast<int>(scene::ToolPart::Kind::capsule) &&
              v1::ToolPart::CYLINDER == static_cast<int>(scene::ToolPart::Kind::cylinder) &&
              v1::ToolPart::BOX == static_cast<int>(scene::ToolPart::Kind::box));

void fill_tool(const scene::Tool& from, v1::SceneTool* to) {
  to->set_by_penalty(from.contact() == scene::ToolContact::penalty);
  for (const scene::ToolPoint& point : from.points()) {
    for (const double number : {point.at_m.x(), point.at_m.y(), point.at_m.z(), point.radius_m}) to->add_point(number);
  }
  for (const scene::ToolPart& part : from.parts()) {
    v1::ToolPart& packed = *to->add_part();
    packed.set_kind(static_cast<v1::ToolPart::Kind>(part.kind));
    fill(part.from_m, packed.mutable_from());
    fill(part.to_m, packed.mutable_to());
    packed.set_radius(part.radius_m);
  }
}

void append_hash(const Cut& cut, v1::Geometry& geometry) {
  const Hash hash = hash_of(std::as_bytes(std::span(cut.bytes)));
  geometry.mutable_hashes()->append(reinterpret_cast<const char*>(hash.data()), kHashBytes);
}

Box everywhere() {
  const Point far = Point::Constant(std::numeric_limits<double>::infinity());
  const Point low = -far;
  return {low, far};
}

/// The values that go beside a geometry: rows and files only where they must be given, and of files the name alone.
config::Values without_geometry(const scene::SceneObject& object) {
  static const scene::Registry kKnown = scene::Registry::standard();
  const config::Values& values = object.shape_values;
  config::Values rest;
  for (const config::Parameter& parameter : kKnown.find_shape(object.shape_kind)->parameters) {
    const std::string_view key = config::key_of(parameter);
    if (!values.has(key)) continue;
    const auto* const text = std::get_if<config::TextParameter>(&parameter);
    const bool is_file = text != nullptr && text->form == config::TextParameter::Form::file;
    const bool replaced = is_file || std::holds_alternative<config::RowsParameter>(parameter);
    if (replaced && config::may_be_left_out(parameter)) continue;
    if (is_file) {
      rest.set(key, std::filesystem::path(values.text(key)).filename().string());
    } else {
      rest.set(key, values.all().find(key)->second);
    }
  }
  return rest;
}

/// By a god object that is outside of it.
bool is_felt_from_outside(const scene::SceneObject& object) {
  const config::Values& values = object.shape_values;
  return object.shape_kind == "mesh" && !(values.has("two_sided") && values.flag("two_sided"));
}

/// Gathers triangles until a piece is full.
class MeshPieceWriter {
 public:
  explicit MeshPieceWriter(const scene::TriangleMesh& mesh) : mesh_(mesh) {}

  /// False, with nothing done, if it has no room for it.
  [[nodiscard]] bool add(std::uint32_t triangle) {
    // A vertex: its place (at most 5 bytes) and 24; a triangle: its number and three corners; the rest: tags, lengths.
    constexpr std::size_t kVertexBytes = 29;
    constexpr std::size_t kTriangleBytes = 8;
    constexpr std::size_t kOtherBytes = 32;
    constexpr std::size_t kVerticesMax = 256;
    std::size_t vertices = vertices_.size();
    for (const std::uint32_t vertex : mesh_.triangles()[triangle]) vertices += vertices_.contains(vertex) ? 0 : 1;
    const std::size_t bytes = kOtherBytes + vertices * kVertexBytes + (triangles_.size() + 1) * kTriangleBytes;
    if (bytes > kPieceBytesMax || vertices > kVerticesMax) return false;
    triangles_.push_back(triangle);
    for (const std::uint32_t vertex : mesh_.triangles()[triangle]) vertices_.emplace(vertex, 0);
    return true;
  }

  [[nodiscard]] bool empty() const { return triangles_.empty(); }

  Cut take() {
    Cut cut;
    v1::MeshPiece piece;
    std::uint32_t before = 0;
    std::uint32_t place = 0;
    for (auto& [vertex, at] : vertices_) {
      const Point& position_m = mesh_.vertices_m()[vertex];
      piece.add_vertex(vertex - std::exchange(before, vertex));
      for (Eigen::Index axis = 0; axis < 3; ++axis) piece.add_position(position_m[axis]);
      cut.where_m.extend(position_m);
      at = place++;
    }
    std::ranges::sort(triangles_);
    before = 0;
    for (const std::uint32_t triangle : triangles_) {
      piece.add_triangle(triangle - std::exchange(before, triangle));
      for (const std::uint32_t vertex : mesh_.triangles()[triangle])
        piece.mutable_corners()->push_back(static_cast<char>(vertices_.at(vertex)));
    }
    cut.bytes = piece.SerializeAsString();
    triangles_.clear();
    vertices_.clear();
    return cut;
  }

 private:
  const scene::TriangleMesh& mesh_;
  std::vector<std::uint32_t> triangles_;
  std::map<std::uint32_t, std::uint32_t> vertices_;
};

void put_number(std::string& to, double steps) {
  const auto number = static_cast<unsigned>(std::clamp(steps, 0.0, kBoxSteps));
  to.push_back(static_cast<char>(number & 0xFFU));
  to.push_back(static_cast<char>(number >> 8U));
}

/// A bit larger than it is.
void put_box(std::string& to, const Box& box_m, const Box& whole_m) {
  const auto steps = [&](const Point& corner, Eigen::Index axis) {
    const double size_m = whole_m.sizes()[axis];
    return size_m > 0 ? (corner[axis] - whole_m.min()[axis]) / size_m * kBoxSteps : 0.0;
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) put_number(to, std::floor(steps(box_m.min(), axis)) - 1);
  for (Eigen::Index axis = 0; axis < 3; ++axis) put_number(to, std::ceil(steps(box_m.max(), axis)) + 1);
}

std::vector<Cut> cut_mesh(const scene::Bvh& bvh, v1::Geometry& geometry) {
  const scene::TriangleMesh& mesh = bvh.mesh();
  const scene::MeshFrame frame = mesh.frame();
  fill(frame.origin_m, geometry.mutable_origin());
  fill(frame.box_m.min(), geometry.mutable_box_low());
  fill(frame.box_m.max(), geometry.mutable_box_high());
  geometry.set_vertices(static_cast<std::uint32_t>(mesh.vertices_m().size()));
  geometry.set_triangles(static_cast<std::uint32_t>(mesh.triangles().size()));
  geometry.set_open_edges(static_cast<std::uint32_t>(frame.report.open_edges));
  geometry.set_non_manifold_edges(static_cast<std::uint32_t>(frame.report.non_manifold_edges));
  geometry.set_inconsistent_edges(static_cast<std::uint32_t>(frame.report.inconsistent_edges));
  geometry.set_volume_m3(frame.report.volume_m3);

  // In the order of the tree those near to each other follow each other.
  std::vector<Cut> cuts;
  MeshPieceWriter writer(mesh);
  for (const std::uint32_t triangle : bvh.order()) {
    if (writer.add(triangle)) continue;
    cuts.push_back(writer.take());
    (void)writer.add(triangle);
  }
  if (!writer.empty()) cuts.push_back(writer.take());
  for (Cut& cut : cuts) {
    put_box(*geometry.mutable_boxes(), cut.where_m, frame.box_m);
    cut.where_m.translate(frame.origin_m);
  }
  return cuts;
}

/// About boxes as `put_box` writes them.
std::string box_about(std::string_view boxes) {
  const auto number = [&](std::size_t at) {
    return static_cast<unsigned>(static_cast<unsigned char>(boxes[at])) +
           256U * static_cast<unsigned char>(boxes[at + 1]);
  };
  std::string about;
  for (std::size_t at = 0; at < kBoxBytes; at += 2) {
    const bool is_low = at < kBoxBytes / 2;
    unsigned furthest = number(at);
    for (std::size_t next = at + kBoxBytes; next < boxes.size(); next += kBoxBytes)
      furthest = is_low ? std::min(furthest, number(next)) : std::max(furthest, number(next));
    put_number(about, furthest);
  }
  return about;
}

/// Moves hashes and boxes of a large mesh's pieces from its manifest into lists. @returns these, as pieces
std::vector<Cut> cut_lists(std::span<const Cut> cuts, v1::Geometry& geometry) {
  const std::string hashes = std::exchange(*geometry.mutable_hashes(), {});
  const std::string boxes = std::exchange(*geometry.mutable_boxes(), {});
  geometry.set_listed(static_cast<std::uint32_t>(cuts.size()));
  std::vector<Cut> lists;
  for (std::size_t begin = 0; begin < cuts.size(); begin += kListed) {
    v1::PieceList list;
    list.set_hashes(hashes.substr(begin * kHashBytes, kListed * kHashBytes));
    list.set_boxes(boxes.substr(begin * kBoxBytes, kListed * kBoxBytes));
    geometry.mutable_boxes()->append(box_about(list.boxes()));
    Cut cut{.bytes = list.SerializeAsString(), .where_m = {}, .comes_first = cuts[begin].comes_first};
    for (const Cut& named : cuts.subspan(begin, std::min(kListed, cuts.size() - begin)))
      cut.where_m.extend(named.where_m);
    append_hash(cut, geometry);
    lists.push_back(std::move(cut));
  }
  return lists;
}

std::vector<Cut> cut_heights(const scene::HeightGrid& grid, v1::Geometry& geometry) {
  const std::size_t rows = grid.heights_m.size() / grid.columns;
  fill(grid.origin_m, geometry.mutable_origin());
  geometry.set_spacing(grid.spacing_m);
  geometry.set_columns(static_cast<std::uint32_t>(grid.columns));
  geometry.set_rows(static_cast<std::uint32_t>(rows));
  std::vector<Cut> cuts;
  for (std::size_t row = 0; row < rows; row += kTile) {
    for (std::size_t column = 0; column < grid.columns; column += kTile) {
      Cut cut;
      v1::HeightPiece piece;
      piece.set_column(static_cast<std::uint32_t>(column));
      piece.set_row(static_cast<std::uint32_t>(row));
      const std::size_t columns = std::min(kTile, grid.columns - column);
      piece.set_columns(static_cast<std::uint32_t>(columns));
      for (std::size_t r = row; r < std::min(row + kTile, rows); ++r) {
        for (std::size_t c = column; c < column + columns; ++c) {
          const double height_m = grid.heights_m[r * grid.columns + c];
          piece.add_height(height_m);
          cut.where_m.extend(grid.origin_m + Point(grid.spacing_m * static_cast<double>(c),
                                                   grid.spacing_m * static_cast<double>(r), height_m));
        }
      }
      cut.bytes = piece.SerializeAsString();
      cuts.push_back(std::move(cut));
    }
  }
  return cuts;
}

/// Writes the manifest, and with it the pieces of its geometries.
class ManifestWriter {
 public:
  explicit ManifestWriter(const scene::Scene& scene) {
    manifest_.set_name(scene.facts().name);
    manifest_.set_degrees_of_freedom(scene.facts().degrees_of_freedom);
    if (scene.facts().tool) fill_tool(*scene.facts().tool, manifest_.mutable_tool());
    std::size_t part = 0;
    for (const scene::SceneObject& object : scene.objects()) {
      if (scene.rendering_of_part(part++).how == scene::Rendering::at_client) add(object, manifest_.add_objects());
    }
    for (const scene::SceneObject& field : scene.fields()) {
      if (scene.rendering_of_part(part++).how == scene::Rendering::at_client) add(field, manifest_.add_fields());
    }
    for (const scene::SceneDynamicModel& model : scene.dynamic_models()) {
      if (scene.rendering_of_part(part++).how != scene::Rendering::at_client) continue;
      add(dynamic_cast<const scene::RunsAtClient&>(*model.dynamic_model).part_at_client(), model.name);
    }
  }

  [[nodiscard]] std::string manifest() const { return manifest_.SerializeAsString(); }
  [[nodiscard]] std::vector<Cut>& cuts() { return cuts_; }

 private:
  void add(const scene::SceneObject& from, v1::ScenePart* to) {
    to->set_name(from.name);
    if (from.shape) {
      const scene::ShapeGeometry geometry = from.shape->geometry();
      const bool has_geometry = geometry.kind() != scene::GeometryKind::none;
      to->set_shape(from.shape_kind);
      fill(has_geometry ? without_geometry(from) : from.shape_values, to->mutable_shape_values());
      if (geometry.mesh) {
        const scene::Bvh tree(geometry.mesh);
        to->set_geometry(add_mesh(tree));
        if (is_felt_from_outside(from)) add_coarse_level_of(tree);
      }
      if (geometry.heights) {
        to->set_geometry(add_geometry([&](v1::Geometry& made) { return cut_heights(*geometry.heights, made); }));
      }
    }
    for (const scene::RequestedEffect& requested : from.effects) {
      v1::SceneEffect* const effect = to->add_effects();
      effect->set_name(requested.name);
      fill(requested.values, effect->mutable_values());
    }
  }

  void add(const scene::PartDescription& from, const std::string& name) {
    v1::ScenePart* const to = manifest_.add_objects();
    to->set_name(name);
    to->set_shape(from.shape->name);
    fill(from.shape->values, to->mutable_shape_values());
    for (const scene::NamedValues& requested : from.effects) {
      v1::SceneEffect* const effect = to->add_effects();
      effect->set_name(requested.name);
      fill(requested.values, effect->mutable_values());
    }
  }

  std::uint32_t add_mesh(const scene::Bvh& tree) {
    return add_geometry([&](v1::Geometry& made) { return cut_mesh(tree, made); });
  }

  /// Of a mesh that was added just now.
  void add_coarse_level_of(const scene::Bvh& tree) {
    const std::optional<CoarseLevel> coarse = coarse_level_of(tree);
    if (!coarse) return;
    const auto full = static_cast<std::uint32_t>(manifest_.geometries_size());
    (void)add_geometry([&](v1::Geometry& made) {
      made.set_coarse_of(full);
      made.set_error_m(coarse->error_m);
      std::vector<Cut> cuts = cut_mesh(scene::Bvh(coarse->mesh), made);
      for (Cut& cut : cuts) cut.comes_first = true;
      return cuts;
    });
  }

  /// @param cut_into fills in the geometry, and returns its pieces. @returns its number
  template <class CutInto>
  std::uint32_t add_geometry(CutInto cut_into) {
    v1::Geometry* const geometry = manifest_.add_geometries();
    std::vector<Cut> cuts = cut_into(*geometry);
    for (const Cut& cut : cuts) append_hash(cut, *geometry);
    if (geometry->triangles() > 0 && cuts.size() > kUnlistedMost)
      std::ranges::move(cut_lists(cuts, *geometry), std::back_inserter(cuts_));
    std::ranges::move(cuts, std::back_inserter(cuts_));
    return static_cast<std::uint32_t>(manifest_.geometries_size());
  }

  v1::SceneManifest manifest_;
  std::vector<Cut> cuts_;
};

}  // namespace

PackedScene::PackedScene(const scene::Scene& scene) {
  ManifestWriter writer(scene);
  const std::string manifest = writer.manifest();
  const auto put = [this](std::string_view bytes, const Box& where_m, bool comes_first) {
    if (bytes.size() > kPieceBytesMax) throw scene::GeometryError("a piece of the scene has no place in a datagram");
    pieces_.push_back({bytes_.size(), bytes.size(), where_m, comes_first});
    const auto raw = std::as_bytes(std::span(bytes));
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  };
  for (std::size_t begin = 0; begin < manifest.size(); begin += kPieceBytesMax)
    put(std::string_view(manifest).substr(begin, kPieceBytesMax), everywhere(), true);
  for (const Cut& cut : writer.cuts()) put(cut.bytes, cut.where_m, cut.comes_first);
  announcement_ = {
      .hash = hash_of(std::as_bytes(std::span(manifest))), .manifest_bytes = manifest.size(), .pieces = pieces_.size()};
}

std::span<const std::byte> PackedScene::piece(std::size_t number) const noexcept {
  return std::span(bytes_).subspan(pieces_[number].begin, pieces_[number].bytes);
}

std::shared_ptr<const PackedScene> pack(const scene::Scene& scene) {
  return scene.can_be_handed_over() ? std::make_shared<const PackedScene>(scene) : nullptr;
}

}  // namespace forcebound::handover
