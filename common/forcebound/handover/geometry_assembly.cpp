#include "forcebound/handover/internal/geometry_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "forcebound/handover/coarse_level.hpp"
#include "forcebound/handover/handover_error.hpp"
#include "forcebound/handover/hash.hpp"
#include "forcebound/handover/internal/proto_values.hpp"
#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::handover {
namespace {

using Box = Eigen::AlignedBox3d;

// Heights, their origin and their spacing lie within this, so that their squares are finite.
constexpr double kFar_m = 1e6;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// How many triangles lie about the fullest of some hundred places; more than `most` count as one more than that.
std::size_t in_fullest_place(const scene::Bvh& bvh, std::size_t most) {
  constexpr std::size_t kSamples = 512;
  const scene::TriangleMesh& mesh = bvh.mesh();
  std::vector<std::uint32_t> places(most);
  const std::size_t step = std::max<std::size_t>(1, mesh.triangles().size() / kSamples);
  std::size_t fullest = 0;
  for (std::size_t i = 0; i < mesh.triangles().size() && fullest <= most; i += step) {
    const Point middle_m = (mesh.corner_m(i, 0) + mesh.corner_m(i, 1) + mesh.corner_m(i, 2)) / 3;
    fullest = std::max(fullest, bvh.gather(Box(middle_m, middle_m), places).value_or(most + 1));
  }
  return fullest;
}

/// @param hashes of several pieces, of which this one has that place
void check_hash(std::size_t number, std::span<const std::byte> bytes, std::string_view hashes, std::size_t place) {
  const Hash hash = hash_of(bytes);
  const auto named = std::as_bytes(std::span(hashes)).subspan(place * kHashBytes, kHashBytes);
  if (!std::ranges::equal(std::span(hash).first(kHashBytes), named))
    throw HandoverError("piece " + std::to_string(number) + " has another hash than the manifest says");
}

}  // namespace

GeometryAssembly::GeometryAssembly(const v1::Geometry& geometry, std::size_t first)
    : geometry_(geometry), first_(first) {
  const std::size_t named = geometry.hashes().size() / kHashBytes;
  const std::size_t pieces = geometry.listed() > 0 ? geometry.listed() : named;
  const bool is_grid = geometry.columns() > 0 || geometry.rows() > 0;
  const bool sound = is_mesh() != is_grid && pieces > 0 && geometry.hashes().size() % kHashBytes == 0;
  const std::size_t heights = std::size_t{geometry.columns()} * geometry.rows();
  if (!sound || (geometry.listed() > 0 && (!is_mesh() || named != lists_of(pieces))) ||
      (is_mesh() && (geometry.boxes().size() != named * kBoxBytes || pieces > geometry.triangles() ||
                     geometry.vertices() > 3 * std::size_t{geometry.triangles()})) ||
      (is_grid && pieces != tiles(geometry.columns(), geometry.rows()))) {
    throw HandoverError("a geometry of the manifest contradicts itself");
  }
  contents_.resize(pieces);
  if (geometry.listed() > 0) {
    lists_.resize(named);
    hashes_.resize(pieces * kHashBytes);
    boxes_.resize(pieces * kBoxBytes);
  } else {
    hashes_ = geometry.hashes();
    boxes_ = geometry.boxes();
  }
  if (is_grid) {
    // The largest of numbers passes over one that is none.
    const Point origin_m = point_of(geometry.origin());
    const bool placed = origin_m.allFinite() && origin_m.cwiseAbs().maxCoeff() <= kFar_m;
    if (!placed || !(geometry.spacing() > 0 && geometry.spacing() <= kFar_m) || geometry.columns() < 2 ||
        geometry.rows() < 2) {
      throw HandoverError("a height field of the manifest must have 2 columns and rows, and lie within 1e6 m");
    }
    heights_m_.resize(heights);
    return;
  }
  frame_ = {.origin_m = point_of(geometry.origin()),
            .box_m = Box(point_of(geometry.box_low()), point_of(geometry.box_high())),
            .report = {.triangles = geometry.triangles(),
                       .vertices = geometry.vertices(),
                       .open_edges = geometry.open_edges(),
                       .non_manifold_edges = geometry.non_manifold_edges(),
                       .inconsistent_edges = geometry.inconsistent_edges(),
                       .volume_m3 = geometry.volume_m3()}};
  if (!frame_.origin_m.allFinite() || !frame_.box_m.min().allFinite() || !frame_.box_m.max().allFinite() ||
      frame_.box_m.isEmpty() || !std::isfinite(geometry.volume_m3())) {
    throw HandoverError("a mesh of the manifest lies nowhere: its box is empty or not finite");
  }
  if (coarse_of() != 0 && !(frame_.report.closed() && error_m() >= 0 && error_m() <= kCoarseErrorMost_m)) {
    throw HandoverError("a coarse level of the manifest must be closed, and its error within 0 to " +
                        text::to_text(kCoarseErrorMost_m) + " m, got " + text::to_text(error_m()));
  }
  vertices_m_.assign(geometry.vertices(), Point::Constant(kNan));
  triangles_.assign(geometry.triangles(), {kUnknown, kUnknown, kUnknown});
}

bool GeometryAssembly::knows_hash_of(std::size_t number) const noexcept {
  const std::size_t place = number - first_;
  return place < lists_.size() || lists_.empty() || !lists_[(place - lists_.size()) / kListed].empty();
}

GeometryAssembly::Listed GeometryAssembly::listed_by(std::size_t number) const noexcept {
  const std::size_t list = number - first_;
  if (list >= lists_.size()) return {};
  const std::size_t begin = first_ + lists_.size();
  return {.first = begin + list * kListed, .end = begin + std::min((list + 1) * kListed, contents_.size())};
}

void GeometryAssembly::add_list(std::size_t number, std::span<const std::byte> bytes) {
  const std::size_t list = number - first_;
  check_hash(number, bytes, geometry_.hashes(), list);
  v1::PieceList read;
  if (!read.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw HandoverError("piece " + std::to_string(number) + " cannot be read");
  const Listed named = listed_by(number);
  const std::size_t pieces = named.end - named.first;
  if (read.hashes().size() != pieces * kHashBytes || read.boxes().size() != pieces * kBoxBytes)
    throw HandoverError("a list of a mesh's pieces has another length than the manifest says");
  const Box whole_m = mesh_box_m(geometry_.boxes(), list);
  for (std::size_t i = 0; i < pieces; ++i) {
    const Box box_m = mesh_box_m(read.boxes(), i);
    if (!box_m.isEmpty() && !whole_m.contains(box_m))
      throw HandoverError("a list of a mesh's pieces names one outside of its box");
  }
  const std::size_t first = list * kListed;
  hashes_.replace(first * kHashBytes, read.hashes().size(), read.hashes());
  boxes_.replace(first * kBoxBytes, read.boxes().size(), read.boxes());
  lists_[list].assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

void GeometryAssembly::add(std::size_t number, std::span<const std::byte> bytes) {
  if (number - first_ < lists_.size()) {
    add_list(number, bytes);
    return;
  }
  const std::size_t place = number - first_ - lists_.size();
  check_hash(number, bytes, hashes_, place);
  v1::MeshPiece mesh;
  v1::HeightPiece heights;
  google::protobuf::MessageLite& piece = is_mesh() ? static_cast<google::protobuf::MessageLite&>(mesh) : heights;
  if (!piece.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw HandoverError("piece " + std::to_string(number) + " cannot be read");
  if (is_mesh()) {
    add_triangles(mesh, place);
  } else {
    add_heights(heights, place);
  }
  contents_[place].assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  ++here_;
}

void GeometryAssembly::add_triangles(const v1::MeshPiece& piece, std::size_t number_of_piece) {
  const auto wrong = [] { throw HandoverError("a piece of a mesh contradicts itself or the manifest"); };
  std::vector<std::uint32_t> vertices;
  std::uint64_t number = 0;
  // Where it is missing shows by its box. Half a step for rounding.
  const Box reported_m = mesh_box_m(boxes_, number_of_piece);
  const Point rounding_m = 0.5 / kBoxSteps * frame_.box_m.sizes();
  const Box box_m(reported_m.min() - rounding_m, reported_m.max() + rounding_m);
  if (piece.position_size() != 3 * piece.vertex_size()) wrong();
  for (int i = 0; i < piece.vertex_size(); ++i) {
    number += piece.vertex(i);
    const Point position_m(piece.position(3 * i), piece.position(3 * i + 1), piece.position(3 * i + 2));
    if (number >= vertices_m_.size()) wrong();
    if (!position_m.allFinite()) throw HandoverError("a vertex is not finite");
    if (!box_m.contains(position_m)) throw HandoverError("a piece of a mesh lies outside of its box");
    Point& known_m = vertices_m_[number];
    if (!known_m.hasNaN() && known_m != position_m) wrong();
    known_m = position_m;
    vertices.push_back(static_cast<std::uint32_t>(number));
  }
  const std::string& corners = piece.corners();
  if (corners.size() != 3 * static_cast<std::size_t>(piece.triangle_size())) wrong();
  number = 0;
  for (int i = 0; i < piece.triangle_size(); ++i) {
    number += piece.triangle(i);
    if (number >= triangles_.size() || triangles_[number][0] != kUnknown) wrong();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto place = static_cast<unsigned char>(corners[3 * static_cast<std::size_t>(i) + corner]);
      if (place >= vertices.size()) wrong();
      triangles_[number][corner] = vertices[place];
    }
  }
}

void GeometryAssembly::add_heights(const v1::HeightPiece& piece, std::size_t number) {
  const std::size_t across = (geometry_.columns() + kTile - 1) / kTile;
  const std::size_t column = number % across * kTile;
  const std::size_t row = number / across * kTile;
  const std::size_t columns = std::min(kTile, geometry_.columns() - column);
  const std::size_t rows = std::min(kTile, geometry_.rows() - row);
  if (piece.column() != column || piece.row() != row || piece.columns() != columns ||
      static_cast<std::size_t>(piece.height_size()) != columns * rows) {
    throw HandoverError("a piece of a height field lies elsewhere than its number says");
  }
  for (std::size_t i = 0; i < columns * rows; ++i) {
    const double height_m = piece.height(static_cast<int>(i));
    if (!(std::abs(height_m) <= kFar_m)) throw HandoverError("a height is not within 1e6 m");
    heights_m_[(row + i / columns) * geometry_.columns() + column + i % columns] = height_m;
  }
}

GeometryAssembly::Made GeometryAssembly::made(const Limits& limits) const {
  if (is_mesh()) {
    auto mesh = made_mesh();
    auto tree = std::make_shared<const scene::Bvh>(mesh);
    const std::size_t fullest = in_fullest_place(*tree, limits.triangles_in_one_place);
    if (fullest > limits.triangles_in_one_place) {
      throw HandoverError("a mesh has more than " + std::to_string(limits.triangles_in_one_place) +
                          " triangles in one place");
    }
    return {.geometry = {.mesh = std::move(mesh), .tree = std::move(tree)}, .in_fullest_place = fullest};
  }
  scene::HeightGrid grid{.origin_m = point_of(geometry_.origin()),
                         .spacing_m = geometry_.spacing(),
                         .columns = geometry_.columns(),
                         .heights_m = heights_m_};
  return {.geometry = {.heights = std::make_shared<const scene::HeightGrid>(std::move(grid))}};
}

std::shared_ptr<const scene::TriangleMesh> GeometryAssembly::made_mesh() const {
  std::vector<Point> vertices_m = vertices_m_;
  for (Point& vertex_m : vertices_m) {
    if (vertex_m.hasNaN()) vertex_m = frame_.box_m.min();  // of no triangle that is there
  }
  std::vector<scene::Triangle> triangles;
  triangles.reserve(triangles_.size());
  std::ranges::copy_if(triangles_, std::back_inserter(triangles),
                       [](const scene::Triangle& triangle) { return triangle[0] != kUnknown; });
  if (whole() && triangles.size() != triangles_.size()) throw HandoverError("a mesh lacks triangles of the manifest");
  return std::make_shared<const scene::TriangleMesh>("mesh", vertices_m, triangles, frame_);
}

Box GeometryAssembly::whole_box_m() const {
  if (is_mesh()) return frame_.box_m.translated(frame_.origin_m);
  const Point origin_m = point_of(geometry_.origin());
  const double spacing_m = geometry_.spacing();
  // Flat, because what is missing is so however high one is above it.
  return {origin_m, Point(origin_m.x() + spacing_m * (geometry_.columns() - 1.0),
                          origin_m.y() + spacing_m * (geometry_.rows() - 1.0), origin_m.z())};
}

Box GeometryAssembly::mesh_box_m(std::string_view boxes, std::size_t place) const {
  const auto* const from = reinterpret_cast<const unsigned char*>(boxes.data()) + place * kBoxBytes;
  const auto corner = [&](std::size_t at) {
    Point share;
    for (Eigen::Index axis = 0; axis < 3; ++axis, at += 2)
      share[axis] = (static_cast<double>(from[at]) + 256.0 * from[at + 1]) / kBoxSteps;
    return Point(frame_.box_m.min() + share.cwiseProduct(frame_.box_m.sizes()));
  };
  return {corner(0), corner(kBoxBytes / 2)};
}

Box GeometryAssembly::box_m(std::size_t piece) const {
  if (is_mesh()) return mesh_box_m(boxes_, piece).translated(frame_.origin_m);
  // A place between heights is felt by those about it and by the slopes there, which their neighbours say.
  constexpr double kReach = 2;
  const std::size_t across = (geometry_.columns() + kTile - 1) / kTile;
  const std::size_t tile_row = piece / across;
  const auto column = static_cast<double>(piece % across * kTile);
  const auto row = static_cast<double>(tile_row * kTile);
  const Point origin_m = point_of(geometry_.origin());
  const double spacing_m = geometry_.spacing();
  constexpr double kFar = std::numeric_limits<double>::infinity();
  return {Point(origin_m.x() + spacing_m * (column - kReach), origin_m.y() + spacing_m * (row - kReach), -kFar),
          Point(origin_m.x() + spacing_m * (column + kTile + kReach), origin_m.y() + spacing_m * (row + kTile + kReach),
                kFar)};
}

/// A box about each piece that is not there; about all of a list that is not there, one.
template <class Use>
void GeometryAssembly::for_each_missing_m(Use use) const {
  for (std::size_t i = 0; i < contents_.size(); ++i) {
    if (!contents_[i].empty()) continue;
    if (lists_.empty() || !lists_[i / kListed].empty()) {
      use(box_m(i));
    } else if (i % kListed == 0) {
      use(mesh_box_m(geometry_.boxes(), i / kListed).translated(frame_.origin_m));
    }
  }
}

Coverage GeometryAssembly::coverage() const {
  std::vector<Box> missing_m;
  for_each_missing_m([&](const Box& box_m) { missing_m.push_back(box_m); });
  return {whole_box_m(), missing_m};
}

double GeometryAssembly::known_within_m(const Point& point_m) const {
  double least_m = std::numeric_limits<double>::infinity();
  for_each_missing_m([&](const Box& box_m) { least_m = std::min(least_m, box_m.exteriorDistance(point_m)); });
  return least_m;
}

void GeometryAssembly::append_content(std::vector<std::byte>& to) const {
  for (const auto* const contents : {&lists_, &contents_}) {
    for (const std::string& content : *contents) {
      // Its length first, in two bytes.
      to.push_back(static_cast<std::byte>(content.size() & 0xFFU));
      to.push_back(static_cast<std::byte>(content.size() >> 8U));
      const auto bytes = std::as_bytes(std::span(content));
      to.insert(to.end(), bytes.begin(), bytes.end());
    }
  }
}

}  // namespace forcebound::handover
