#include "forcebound/tissue/tissue_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "forcebound/text/numbers.hpp"
#include "forcebound/tissue/set_up.hpp"
#include "forcebound/tissue/tetrahedral_block.hpp"

namespace forcebound::tissue {
namespace {

constexpr double kStiffest_N_per_m = 1e9;
constexpr double kStiffest_Pa = 1e12;

class TissueShape final : public scene::Shape {
 public:
  explicit TissueShape(TissueModel model) : model_(std::move(model)), extent_(model_.tissue().mesh()) {}

  scene::SurfacePoint nearest(const scene::Point& position_m, std::byte* state) const noexcept override {
    TissueState& probe = *std::launder(reinterpret_cast<TissueState*>(state));
    if (extent_.lets_go(probe, position_m)) probe = {};
    const TissueResult result = model_.step(probe, position_m);
    // Not a number: it is left out from then on, as at the server.
    if (!result.finite) return {.normal = scene::Point::Constant(std::numeric_limits<double>::quiet_NaN())};
    if (result.contacts == 0) return {.penetration_m = -std::numeric_limits<double>::max()};
    return {.normal = result.normal,
            .penetration_m = result.force_N.norm() / model_.options().contact_stiffness_N_per_m};
  }

  void begin_outside(const scene::Point& free_m, std::byte* state) const noexcept override {
    (void)nearest(free_m, state);
  }

  scene::ShapeFacts facts() const override {
    scene::ShapeFacts facts{.state_bytes = sizeof(TissueState),
                            .memory_bytes = model_.tissue().memory_bytes(),
                            .cost_ns = model_.step_ns()};
    for (const scene::Point& node_m : model_.tissue().mesh().nodes_m()) facts.bounds_m.extend(node_m);
    return facts;
  }

 private:
  TissueModel model_;
  TissueExtent extent_;
};

[[noreturn]] void refuse_value(std::string_view key, const std::string& what) {
  throw config::ValueError(key, "a tissue's " + std::string(key) + " " + what);
}

/// An index among so many.
std::size_t index_of(std::string_view key, double number, std::size_t count) {
  if (!(number >= 0 && number < static_cast<double>(count)) || number != std::floor(number))
    refuse_value(key, "refer to node " + text::to_text(number) + " of " + std::to_string(count));
  return static_cast<std::size_t>(number);
}

template <std::size_t kCorners>
std::array<std::size_t, kCorners> corners_of(std::string_view key, const std::vector<double>& row, std::size_t nodes) {
  std::array<std::size_t, kCorners> corners{};
  for (std::size_t corner = 0; corner < kCorners; ++corner) corners[corner] = index_of(key, row.at(corner), nodes);
  return corners;
}

/// The server's own to the bit, as all that follows from it, such as the middles.
TetrahedralMesh mesh_of(const config::Values& values) {
  const config::Rows& nodes = values.rows("nodes_m");
  const config::Rows& tetrahedra = values.rows("tetrahedra");
  const config::Rows& boxes = values.rows("boxes");
  const bool middles = values.flag("middles");
  if (!boxes.empty() && (!tetrahedra.empty() || middles)) refuse_value("boxes", "come without tetrahedra or middles");
  const std::size_t elements = boxes.size() + tetrahedra.size();
  if (elements == 0 || elements > kShapeElementsMost)
    refuse_value("tetrahedra",
                 "or boxes are " + std::to_string(elements) + ": expected 1 to " + std::to_string(kShapeElementsMost));
  TetrahedralSoup soup{.name = "tissue", .nodes = {}, .tetrahedra = {}};
  for (const std::vector<double>& row : nodes) {
    const scene::Point node_m(row[0], row[1], row[2]);
    if (!(node_m.cwiseAbs().maxCoeff() <= scene::kLengthMost_m)) refuse_value("nodes_m", "are farther than any device");
    soup.nodes.push_back(node_m);
  }
  for (const std::vector<double>& row : tetrahedra)
    soup.tetrahedra.push_back({.nodes = corners_of<4>("tetrahedra", row, nodes.size())});
  for (const std::vector<double>& row : boxes) add_box(soup, corners_of<8>("boxes", row, nodes.size()));
  const TetrahedralMesh mesh(soup);
  if (mesh.nodes_m().size() != nodes.size()) refuse_value("nodes_m", "include some that no element has");
  return middles ? mesh.with_middles() : mesh;
}

std::unique_ptr<scene::Shape> make_tissue(const config::Values& values) {
  TetrahedralMesh mesh = mesh_of(values);
  std::vector<int> held;
  for (const std::vector<double>& row : values.rows("held"))
    held.push_back(static_cast<int>(index_of("held", row[0], mesh.nodes_m().size())));
  if (!(predicted_set_up_s(mesh, held, false) <= kShapeSetUpMost_s))
    refuse_value("tetrahedra", "would take more than " + text::to_text(kShapeSetUpMost_s) + " s to set up");
  const ElasticMaterial material{.young_Pa = values.number("young_Pa"), .poisson = values.number("poisson")};
  const ProbeOptions probe{.radius_m = values.number("probe_radius_m"),
                           .contact_stiffness_N_per_m = values.number("contact_stiffness_N_per_m"),
                           .contacts_max = values.whole("contacts_max")};
  return std::make_unique<TissueShape>(
      TissueModel(LinearTissue(std::move(mesh), material, held, kShapeBytesMost), probe));
}

template <class Row>
config::Rows rows_of(std::span<const Row> from) {
  config::Rows rows;
  rows.reserve(from.size());
  for (const Row& row : from) rows.emplace_back(row.begin(), row.end());
  return rows;
}

}  // namespace

scene::ShapeKind tissue_shape() {
  return {.name = "tissue",
          .description = "Linear tissue as a client is handed it.",
          .parameters =
              {config::RowsParameter{.key = "nodes_m", .meaning = "in the scene", .columns = 3},
               config::RowsParameter{.key = "tetrahedra", .meaning = "four nodes each, from 0", .columns = 4},
               config::FlagParameter{.key = "middles", .meaning = "of their edges are nodes too, after the others"},
               config::RowsParameter{.key = "boxes", .meaning = "eight nodes each, in place of those", .columns = 8},
               config::RowsParameter{.key = "held", .meaning = "nodes that do not move", .columns = 1},
               config::positive_number("young_Pa", "Young's modulus", kStiffest_Pa),
               config::NumberParameter{.key = "poisson", .meaning = "Poisson's ratio", .least = -1, .most = 0.5},
               config::NumberParameter{.key = "probe_radius_m",
                                       .meaning = "of the sphere that touches it; 0: a point",
                                       .least = 0,
                                       .most = scene::kLengthMost_m},
               config::positive_number("contact_stiffness_N_per_m", "K, of each contact", kStiffest_N_per_m),
               config::NumberParameter{
                   .key = "contacts_max", .meaning = "of a sphere", .least = 1, .most = kContactsMax, .whole = true}},
          .source = "tetrahedra",
          .make = [](const config::Values& values, const scene::ShapePurpose&) { return make_tissue(values); }};
}

bool fits_client(const TissueModel& model, double set_up_s) noexcept {
  const LinearTissue& tissue = model.tissue();
  const auto compliance = static_cast<std::size_t>(tissue.compliance_m_per_N().size());
  return tissue.mesh().elements() <= kShapeElementsMost && compliance <= kShapeBytesMost / sizeof(double) &&
         set_up_s <= kShapeSetUpMost_s && model.step_ns() <= kShapeStepMost_ns &&
         model.options().contact_stiffness_N_per_m <= kStiffest_N_per_m && tissue.material().young_Pa <= kStiffest_Pa;
}

scene::PartDescription tissue_part(const TissueModel& model, const std::vector<int>& held_nodes) {
  const LinearTissue& tissue = model.tissue();
  const TetrahedralMesh& mesh = tissue.mesh();
  const double stiffness_N_per_m = model.options().contact_stiffness_N_per_m;
  const bool of_boxes = !mesh.boxes().empty();
  int last_corner = 0;
  for (const TetrahedralMesh::Tetrahedron& one : mesh.tetrahedra())
    last_corner = std::max(last_corner, std::ranges::max(one));
  const auto corners_m = std::span(mesh.nodes_m()).first(static_cast<std::size_t>(last_corner) + 1);
  config::Rows held;
  for (const int node : held_nodes) held.push_back({static_cast<double>(node)});
  return scene::PartDescription{
      .name = {},
      .shape = scene::NamedValues{"tissue",
                                  {{"nodes_m", rows_of(corners_m)},
                                   {"tetrahedra", of_boxes ? config::Rows{} : rows_of(std::span(mesh.tetrahedra()))},
                                   {"middles", !mesh.middles().empty()},
                                   {"boxes", rows_of(std::span(mesh.boxes()))},
                                   {"held", std::move(held)},
                                   {"young_Pa", tissue.material().young_Pa},
                                   {"poisson", tissue.material().poisson},
                                   {"probe_radius_m", model.options().radius_m},
                                   {"contact_stiffness_N_per_m", stiffness_N_per_m},
                                   {"contacts_max", static_cast<double>(model.options().contacts_max)}}},
      .effects = {{"surface", {{"stiffness_N_per_m", stiffness_N_per_m}}}}};
}

}  // namespace forcebound::tissue
