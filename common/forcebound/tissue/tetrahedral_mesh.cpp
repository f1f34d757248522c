#include "forcebound/tissue/tetrahedral_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::tissue {
namespace {

constexpr int kUnused = -1;

std::string place(const TetrahedralSoup& soup, std::size_t tetrahedron) {
  const std::size_t line = soup.tetrahedra[tetrahedron].line;
  return soup.name + (line == 0 ? "" : ":" + std::to_string(line)) + ": tetrahedron " + std::to_string(tetrahedron + 1);
}

double six_volumes(const std::array<scene::Point, 4>& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]);
}

double longest_edge(const std::array<scene::Point, 4>& corners) {
  double longest = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b) longest = std::max(longest, (corners[a] - corners[b]).norm());
  }
  return longest;
}

// The sides of a tetrahedron of positive volume, each counter-clockwise seen from outside.
std::array<TetrahedralMesh::Triangle, 4> sides(const TetrahedralMesh::Tetrahedron& t) {
  return {{{t[0], t[2], t[1]}, {t[0], t[1], t[3]}, {t[0], t[3], t[2]}, {t[1], t[2], t[3]}}};
}

TetrahedralMesh::Triangle sorted(TetrahedralMesh::Triangle triangle) {
  std::ranges::sort(triangle);
  return triangle;
}

// Whether the corners are an even permutation of the sorted ones.
bool even(const TetrahedralMesh::Triangle& t) {
  return (t[0] < t[1] && t[1] < t[2]) || (t[1] < t[2] && t[2] < t[0]) || (t[2] < t[0] && t[0] < t[1]);
}

}  // namespace

TetrahedralMesh::TetrahedralMesh(const TetrahedralSoup& soup, const scene::MeshPlacement& placement)
    : name_(soup.name) {
  if (!placement.valid()) {
    throw std::runtime_error(soup.name + ": the scale must be > 0, rotation and offset finite, got " +
                             text::to_text(placement.scale));
  }
  if (soup.tetrahedra.empty()) throw std::runtime_error(soup.name + ": expected at least one tetrahedron");
  add_nodes(soup, placement);
  find_surface(soup);
  count_pieces();
}

void TetrahedralMesh::add_nodes(const TetrahedralSoup& soup, const scene::MeshPlacement& placement) {
  std::vector<int> index(soup.nodes.size(), kUnused);
  for (std::size_t t = 0; t < soup.tetrahedra.size(); ++t) {
    for (const std::size_t node : soup.tetrahedra[t].nodes) {
      if (node >= soup.nodes.size()) {
        throw std::runtime_error(place(soup, t) + " names node " + std::to_string(node) + " of " +
                                 std::to_string(soup.nodes.size()));
      }
      index[node] = 0;
    }
  }
  for (std::size_t node = 0; node < index.size(); ++node) {
    if (index[node] == kUnused) continue;
    index[node] = static_cast<int>(nodes_m_.size());
    const scene::Point node_m = placement.scale * soup.nodes[node];
    nodes_m_.emplace_back((placement.turns() ? scene::Point(placement.rotation * node_m) : node_m) +
                          placement.offset_m);
  }
  add_tetrahedra(soup, index);
  add_boxes(soup, index);
}

void TetrahedralMesh::add_tetrahedra(const TetrahedralSoup& soup, const std::vector<int>& index) {
  for (std::size_t t = 0; t < soup.tetrahedra.size(); ++t) {
    Tetrahedron tetrahedron{};
    std::array<scene::Point, 4> corners;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      tetrahedron[corner] = index[soup.tetrahedra[t].nodes[corner]];
      corners[corner] = nodes_m_[tetrahedron[corner]];
      if (!corners[corner].allFinite()) throw std::runtime_error(place(soup, t) + " has a node that is not finite");
    }
    const double longest_m = longest_edge(corners);
    const double volumes = six_volumes(corners);
    const double thickness = volumes / longest_m / longest_m / longest_m;
    // Written so that NaN, from four times the same node, is refused as well.
    if (!(std::abs(thickness) > kFlat)) {
      throw std::runtime_error(place(soup, t) +
                               " is flat: six times its volume over its longest edge's cube must be > " +
                               text::to_text(kFlat) + ", got " + text::rounded(longest_m > 0 ? thickness : 0));
    }
    if (volumes < 0) {
      std::swap(tetrahedron[2], tetrahedron[3]);
      std::swap(corners[2], corners[3]);
    }
    tetrahedra_.push_back(tetrahedron);
    // As whoever is given it turned finds it, to the bit.
    volumes_m3_.push_back(six_volumes(corners) / 6);
  }
}

void TetrahedralMesh::add_boxes(const TetrahedralSoup& soup, const std::vector<int>& index) {
  if (soup.boxes.empty()) return;
  if (soup.tetrahedra.size() != 6 * soup.boxes.size()) {
    throw std::runtime_error(soup.name + ": expected six tetrahedra for each of " + std::to_string(soup.boxes.size()) +
                             " boxes, got " + std::to_string(soup.tetrahedra.size()));
  }
  for (const auto& corners : soup.boxes) {
    Box& box = boxes_.emplace_back();
    std::ranges::transform(corners, box.begin(), [&](std::size_t corner) { return index[corner]; });
  }
  const auto from_first_m = [&](const Box& box, std::size_t corner) -> scene::Point {
    return nodes_m_[box[corner]] - nodes_m_[box[0]];
  };
  Eigen::Matrix3d edges_m;
  edges_m << from_first_m(boxes_[0], 1), from_first_m(boxes_[0], 2), from_first_m(boxes_[0], 4);
  const Eigen::Array3d lengths_m = edges_m.colwise().norm().transpose();
  const Eigen::Matrix3d axes = edges_m * lengths_m.inverse().matrix().asDiagonal();
  if (!((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm() <= kOffMost && axes.determinant() > 0)) {
    throw std::runtime_error(soup.name + ": expected right-angled boxes whose edges are a right-handed frame");
  }
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    for (std::size_t corner = 1; corner < 8; ++corner) {
      const auto [x, y, z] = TetrahedralSoup::steps_to(corner);
      if ((from_first_m(boxes_[b], corner) - edges_m * Eigen::Vector3d(x, y, z)).norm() <=
          kOffMost * lengths_m.minCoeff())
        continue;
      throw std::runtime_error(soup.name + ": box " + std::to_string(b + 1) +
                               " is not as the first: expected boxes that are alike but for their place");
    }
  }
}

void TetrahedralMesh::find_surface(const TetrahedralSoup& soup) {
  struct Sides {
    Triangle first{};
    std::size_t tetrahedron = 0;
    int count = 0;
  };
  std::map<Triangle, Sides> found;
  for (std::size_t t = 0; t < tetrahedra_.size(); ++t) {
    for (const Triangle& side : tissue::sides(tetrahedra_[t])) {
      Sides& known = found[sorted(side)];
      if (++known.count > 2) {
        throw std::runtime_error(place(soup, t) + " is the third at one triangle: expected at most two");
      }
      if (known.count == 1) {
        known.first = side;
        known.tetrahedron = t;
      } else if (even(side) == even(known.first)) {
        throw std::runtime_error(place(soup, t) + " overlaps tetrahedron " + std::to_string(known.tetrahedron + 1) +
                                 ": expected two at one triangle to lie on either side of it");
      }
    }
  }
  for (const auto& [key, known] : found) {
    if (known.count == 1) triangles_.push_back(known.first);
  }
  find_surface_nodes();
}

void TetrahedralMesh::find_surface_nodes() {
  std::vector<bool> on_surface(nodes_m_.size(), false);
  for (const Triangle& triangle : triangles_) {
    for (const int node : triangle) on_surface[node] = true;
  }
  surface_nodes_.clear();
  for (int node = 0; node < static_cast<int>(nodes_m_.size()); ++node) {
    if (on_surface[node]) surface_nodes_.push_back(node);
  }
}

void TetrahedralMesh::count_pieces() {
  std::vector<int> joined_to(nodes_m_.size());
  std::iota(joined_to.begin(), joined_to.end(), 0);
  const auto root_of = [&](int node) {
    while (joined_to[node] != node) node = joined_to[node] = joined_to[joined_to[node]];
    return node;
  };
  for (const Tetrahedron& tetrahedron : tetrahedra_) {
    for (const int node : tetrahedron) joined_to[root_of(node)] = root_of(tetrahedron[0]);
  }
  for (int node = 0; node < static_cast<int>(joined_to.size()); ++node) pieces_ += joined_to[node] == node ? 1 : 0;
  std::vector<std::array<double, 3>> places;
  for (const scene::Point& node_m : nodes_m_) places.push_back({node_m.x(), node_m.y(), node_m.z()});
  std::ranges::sort(places);
  coincident_nodes_ = static_cast<int>(places.end() - std::unique(places.begin(), places.end()));
}

TetrahedralMesh TetrahedralMesh::with_middles() const {
  TetrahedralMesh finer = *this;
  std::map<std::pair<int, int>, int> middles;
  const auto middle_of = [&](int a, int b) {
    const auto [known, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(finer.nodes_m_.size()));
    if (is_new) finer.nodes_m_.emplace_back(0.5 * (nodes_m_[a] + nodes_m_[b]));
    return known->second;
  };
  for (const Tetrahedron& corners : tetrahedra_) {
    Middles& of_edges = finer.middles_.emplace_back();
    for (std::size_t e = 0; e < kEdges.size(); ++e)
      of_edges[e] = middle_of(corners[kEdges[e][0]], corners[kEdges[e][1]]);
  }
  finer.triangles_.clear();
  for (const auto& [a, b, c] : triangles_) {
    const int ab = middle_of(a, b);
    const int bc = middle_of(b, c);
    const int ca = middle_of(c, a);
    for (const Triangle& part : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) {
      finer.triangles_.push_back(part);
    }
  }
  finer.find_surface_nodes();
  return finer;
}

double TetrahedralMesh::volume_m3() const noexcept {
  return std::accumulate(volumes_m3_.begin(), volumes_m3_.end(), 0.0);
}

double TetrahedralMesh::mean_edge_m() const noexcept {
  double sum_m = 0;
  for (const Triangle& t : triangles_) {
    for (std::size_t a = 0; a < 3; ++a) sum_m += (nodes_m_[t[a]] - nodes_m_[t[(a + 1) % 3]]).norm();
  }
  return sum_m / (3 * static_cast<double>(triangles_.size()));
}

std::string pieces_in_words(const TetrahedralMesh& mesh) {
  if (mesh.pieces() == 1) return {};
  const auto coincident = static_cast<std::uint64_t>(mesh.coincident_nodes());
  return ", in " + std::to_string(mesh.pieces()) + " pieces" +
         (coincident == 0
              ? ""
              : ", which are not joined where " + text::counted(coincident, "node lies", "nodes lie") + " on others");
}

std::vector<int> nodes_below(const TetrahedralMesh& mesh, const scene::Point& through_m, const scene::Point& normal) {
  std::vector<int> found;
  for (int node = 0; node < static_cast<int>(mesh.nodes_m().size()); ++node) {
    if ((mesh.nodes_m()[node] - through_m).dot(normal) <= 0) found.push_back(node);
  }
  return found;
}

std::vector<int> nodes_in_box(const TetrahedralMesh& mesh, const scene::Point& center_m, const scene::Point& size_m) {
  std::vector<int> found;
  for (int node = 0; node < static_cast<int>(mesh.nodes_m().size()); ++node) {
    const scene::Point from_center_m = mesh.nodes_m()[node] - center_m;
    if ((from_center_m.cwiseAbs().array() <= 0.5 * size_m.array()).all()) found.push_back(node);
  }
  return found;
}

}  // namespace forcebound::tissue
