#include "forcebound/server/tissue/corotational_tissue.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "forcebound/server/tissue/held_stiffness.hpp"
#include "forcebound/server/tissue/rotation.hpp"
#include "forcebound/server/tissue/triangle.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr int kHalvingsMax = 8;           // of a line search
constexpr int kHopsMax = 16;              // of the place from triangle to triangle in one slide
constexpr double kWorthwhile = 1e-4;      // share of the fall that the slope promises (Armijo)
constexpr double kLinearlySolved = 1e-3;  // of the first residual: Newton's method mends the rest

std::array<double, 3> to_array(const Point& point) noexcept { return {point.x(), point.y(), point.z()}; }
Point to_point(const std::array<double, 3>& values) noexcept { return Eigen::Map<const Point>(values.data()); }

}  // namespace

void CorotationalOptions::check() const {
  const auto refuse = [](const std::string& what, double value) {
    throw std::invalid_argument(what + ", got " + text::to_text(value));
  };
  if (!(contact_stiffness_N_per_m > 0) || !std::isfinite(contact_stiffness_N_per_m)) {
    refuse("contact_stiffness_N_per_m must be > 0", contact_stiffness_N_per_m);
  }
  if (iterations_max < 1) refuse("iterations_max must be >= 1", iterations_max);
  if (linear_iterations_max < 1) refuse("linear_iterations_max must be >= 1", linear_iterations_max);
  if (!(tolerance > 0 && tolerance < 1)) refuse("tolerance must be > 0 and < 1", tolerance);
}

CorotationalTissue::CorotationalTissue(TetrahedralMesh mesh, const ElasticMaterial& material,
                                       const std::vector<int>& held_nodes, const CorotationalOptions& options)
    : mesh_(std::move(mesh)),
      material_(material),
      options_(options),
      surface_(mesh_.nodes_m(), mesh_.triangles()),
      gradients_(shape_gradients(mesh_)),
      free_(static_cast<int>(mesh_.nodes_m().size()), held_nodes),
      tolerance_m_(options.tolerance * mesh_.mean_edge_m()) {
  material_.check();
  options_.check();
  if (free_.count() == 0) throw std::runtime_error(mesh_.name() + ": all nodes are held: expected some that can move");
  SparseCholesky cholesky;
  factorise(cholesky, free_.reduced(stiffness_matrix(mesh_, material_)), mesh_.name());
  factors_ = StiffnessFactors(cholesky);
}

CorotationalWorkspace CorotationalTissue::make_workspace() const {
  const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(coordinates()));
  return {.rotations = std::vector<Eigen::Matrix3d>(mesh_.tetrahedra().size(), Eigen::Matrix3d::Identity()),
          .force = zeros,
          .trial = zeros,
          .trial_force = zeros,
          .direction = zeros,
          .residual = zeros,
          .preconditioned = zeros,
          .search = zeros,
          .product = zeros};
}

double CorotationalTissue::elastic_energy(std::span<const double> displacement_m, std::span<double> force_N,
                                          CorotationalWorkspace& workspace) const noexcept {
  std::ranges::fill(force_N, 0.0);
  double energy_J = 0;
  const auto at = [](auto span, int node) { return span.data() + 3 * static_cast<std::ptrdiff_t>(node); };
  for (std::size_t t = 0; t < gradients_.size(); ++t) {
    Eigen::Matrix<double, 3, 4> moved_m;
    for (int a = 0; a < 4; ++a) moved_m.col(a) = Eigen::Map<const Point>(at(displacement_m, mesh_.tetrahedra()[t][a]));
    const Eigen::Matrix3d deformation = Eigen::Matrix3d::Identity() + moved_m * gradients_[t].transpose();
    const Eigen::Matrix3d rotation = nearest_rotation(deformation);
    const Eigen::Matrix3d strain = deformation - rotation;
    const double volume_change = rotation.cwiseProduct(deformation).sum() - 3;
    const double volume_m3 = mesh_.volumes_m3()[t];
    energy_J += volume_m3 * (material_.mu_Pa() * strain.squaredNorm() +
                             0.5 * material_.lambda_Pa() * volume_change * volume_change);
    const Eigen::Matrix3d stress =
        volume_m3 * (2 * material_.mu_Pa() * strain + material_.lambda_Pa() * volume_change * rotation);
    const Eigen::Matrix<double, 3, 4> forces = -stress * gradients_[t];
    for (int a = 0; a < 4; ++a) Eigen::Map<Point>(at(force_N, mesh_.tetrahedra()[t][a])) += forces.col(a);
    workspace.rotations[t] = rotation;
  }
  return energy_J;
}

class CorotationalTissue::Step {
 public:
  Step(const CorotationalTissue& tissue, std::span<double> displacement_m, CorotationalWorkspace& workspace,
       const Point& probe_m, std::span<CorotationalTie> others) noexcept
      : tissue_(tissue),
        displacement_m_(displacement_m.data(), static_cast<Eigen::Index>(displacement_m.size())),
        work_(workspace),
        probe_m_(probe_m),
        others_(others) {}

  TissueResult run(const TissueState& last) noexcept {
    find_shift(last);
    locate(last);
    if (!place_ && others_.empty() && displacement_m_.isZero(0)) return result_;
    for (CorotationalTie& other : others_) other.pulls = false;
    elastic_J_ = elastic(displacement_m_, work_.force);
    if (place_) *place_ = slid(displacement_m_).place;
    let_go();
    while (result_.iterations < tissue_.options_.iterations_max) {
      ++result_.iterations;
      total_force(work_.residual);
      estimate_residual();
      if (result_.residual_m <= tissue_.tolerance_m_) break;
      solve_linearised();
      if (!search_along()) break;
      if (place_) *place_ = slid(displacement_m_).place;
    }
    // Not before: on its way Newton's method may press the surface past a probe that it does not leave.
    let_go();
    conclude();
    return result_;
  }

  [[nodiscard]] TissueState state() const noexcept {
    TissueState next{.started = 1,
                     .contacts = 0,
                     .probe_m = to_array(probe_m_),
                     .shift_m = to_array(shift_m_),
                     .direction = {},
                     .contact = {}};
    if (place_) next.contact[next.contacts++] = {place_->triangle, to_array(place_->weight)};
    return next;
  }

 private:
  using Vector = Eigen::VectorXd;

  // How far the surface near the probe has moved already: without contact the probe counts as where it would be beside
  // the tissue at rest. Which place is nearest depends on that: a fixed point, followed from step to step.
  void find_shift(const TissueState& last) noexcept {
    if (displacement_m_.isZero(0)) return;
    if (last.started != 0) shift_m_ = to_point(last.shift_m);
    SurfacePlace place{.triangle = static_cast<int>(last.contact[0].triangle),
                       .weight = to_point(last.contact[0].weight)};
    if (last.contacts == 0) place = tissue_.surface_.nearest(probe_m_ - shift_m_).place;
    shift_m_ = corners(displacement_m_, place.triangle) * place.weight - tissue_.surface_.at(place);
  }

  void locate(const TissueState& last) noexcept {
    if (last.contacts > 0) {
      place_ = SurfacePlace{.triangle = static_cast<int>(last.contact[0].triangle),
                            .weight = to_point(last.contact[0].weight)};
    } else if (last.started != 0) {
      place_ = tissue_.surface_.entry(to_point(last.probe_m) - to_point(last.shift_m), probe_m_ - shift_m_);
    } else {
      const TissueSurface::Nearest nearest = tissue_.surface_.nearest(probe_m_ - shift_m_);
      if (nearest.height_m < 0) place_ = nearest.place;
    }
  }

  template <typename Displacement>
  double elastic(const Displacement& displacement_m, Vector& force_N) const noexcept {
    const auto size = static_cast<std::size_t>(displacement_m.size());
    return tissue_.elastic_energy({displacement_m.data(), size}, {force_N.data(), size}, work_);
  }

  template <typename Displacement>
  [[nodiscard]] Point node(const Displacement& displacement_m, int index) const noexcept {
    return tissue_.mesh_.nodes_m()[index] + displacement_m.template segment<3>(3 * index);
  }

  template <typename Displacement>
  [[nodiscard]] Eigen::Matrix3d corners(const Displacement& displacement_m, int triangle) const noexcept {
    Eigen::Matrix3d columns;
    for (int a = 0; a < 3; ++a) columns.col(a) = node(displacement_m, tissue_.surface_.triangles()[triangle][a]);
    return columns;
  }

  // From a place to the probe that holds it.
  template <typename Displacement>
  [[nodiscard]] Point stretch(const Displacement& displacement_m, const CorotationalTie& tie) const noexcept {
    return tie.probe_m - corners(displacement_m, tie.place.triangle) * tie.place.weight;
  }

  [[nodiscard]] CorotationalTie own_tie() const noexcept { return {.place = *place_, .probe_m = probe_m_}; }

  // All that hold the tissue.
  template <typename Do>
  void for_each_tie(const Do& act) const noexcept {
    if (place_) act(own_tie());
    for (const CorotationalTie& other : others_) {
      if (!other.pulls) act(other);
    }
  }

  [[nodiscard]] double tie_energy(double square_m2) const noexcept {
    return 0.5 * tissue_.options_.contact_stiffness_N_per_m * square_m2;
  }

  template <typename Displacement>
  [[nodiscard]] double energy_of_others(const Displacement& displacement_m) const noexcept {
    double sum_J = 0;
    for (const CorotationalTie& other : others_) {
      if (!other.pulls) sum_J += tie_energy(stretch(displacement_m, other).squaredNorm());
    }
    return sum_J;
  }

  [[nodiscard]] double total_energy() const noexcept {
    return elastic_J_ + energy_of_others(displacement_m_) +
           (place_ ? tie_energy(stretch(displacement_m_, own_tie()).squaredNorm()) : 0);
  }

  void release_held(Vector& force_N) const noexcept {
    for (int n = 0; n < static_cast<int>(tissue_.mesh_.nodes_m().size()); ++n) {
      if (tissue_.free_.first_of(n) == FreeCoordinates::kHeld) force_N.segment<3>(3 * n).setZero();
    }
  }

  void add_at(const SurfacePlace& place, const Point& at_place_N, Vector& force_N) const noexcept {
    for (int a = 0; a < 3; ++a) {
      force_N.segment<3>(3 * tissue_.surface_.triangles()[place.triangle][a]) += place.weight[a] * at_place_N;
    }
  }

  void total_force(Vector& force_N) const noexcept {
    force_N = work_.force;
    for_each_tie([&](const CorotationalTie& tie) {
      add_at(tie.place, tissue_.options_.contact_stiffness_N_per_m * stretch(displacement_m_, tie), force_N);
    });
    release_held(force_N);
  }

  // What the stiffness at rest would move under the residual forces.
  void precondition(const Vector& force_N, Vector& moved_m) noexcept {
    for (int n = 0; n < static_cast<int>(tissue_.mesh_.nodes_m().size()); ++n) {
      const int first = tissue_.free_.first_of(n);
      if (first != FreeCoordinates::kHeld) work_.trial.segment<3>(first) = force_N.segment<3>(3 * n);
    }
    tissue_.factors_.solve(work_.trial, work_.product, work_.trial_force);
    moved_m.setZero();
    for (int n = 0; n < static_cast<int>(tissue_.mesh_.nodes_m().size()); ++n) {
      const int first = tissue_.free_.first_of(n);
      if (first != FreeCoordinates::kHeld) moved_m.segment<3>(3 * n) = work_.product.segment<3>(first);
    }
  }

  void estimate_residual() noexcept {
    precondition(work_.residual, work_.preconditioned);
    result_.residual_m = work_.preconditioned.lpNorm<Eigen::Infinity>();
  }

  // Of a motion of the tie's place what the tie resists: along a triangle and along an edge it gives way, since the
  // place slides.
  [[nodiscard]] Point held_part(const CorotationalTie& tie, const Point& moved_m) const noexcept {
    const auto weighs = (tie.place.weight.array() > 0).count();
    if (weighs == 1) return moved_m;
    if (weighs == 3) {
      const Point along = stretch(displacement_m_, tie).stableNormalized();
      return along.dot(moved_m) * along;
    }
    const Eigen::Matrix3d here = corners(displacement_m_, tie.place.triangle);
    int away = 0;
    tie.place.weight.minCoeff(&away);
    const Point edge = (here.col((away + 1) % 3) - here.col((away + 2) % 3)).stableNormalized();
    return moved_m - edge.dot(moved_m) * edge;
  }

  // The stiffness with the rotations held, times a displacement.
  void stiffness_times(const Vector& moved_m, Vector& force_N) const noexcept {
    force_N.setZero();
    const double mu_Pa = tissue_.material_.mu_Pa();
    const double lambda_Pa = tissue_.material_.lambda_Pa();
    for (std::size_t t = 0; t < tissue_.gradients_.size(); ++t) {
      const auto& nodes = tissue_.mesh_.tetrahedra()[t];
      Eigen::Matrix<double, 3, 4> corner_m;
      for (int a = 0; a < 4; ++a) corner_m.col(a) = moved_m.segment<3>(3 * nodes[a]);
      const Eigen::Matrix3d& rotation = work_.rotations[t];
      const Eigen::Matrix3d turned_back = rotation.transpose() * (corner_m * tissue_.gradients_[t].transpose());
      Eigen::Matrix3d stress = mu_Pa * (turned_back + turned_back.transpose());
      stress.diagonal().array() += lambda_Pa * turned_back.trace();
      const Eigen::Matrix<double, 3, 4> forces =
          rotation * (tissue_.mesh_.volumes_m3()[t] * stress) * tissue_.gradients_[t];
      for (int a = 0; a < 4; ++a) force_N.segment<3>(3 * nodes[a]) += forces.col(a);
    }
    for_each_tie([&](const CorotationalTie& tie) {
      Point at_place_m = Point::Zero();
      for (int a = 0; a < 3; ++a) {
        at_place_m += tie.place.weight[a] * moved_m.segment<3>(3 * tissue_.surface_.triangles()[tie.place.triangle][a]);
      }
      add_at(tie.place, tissue_.options_.contact_stiffness_N_per_m * held_part(tie, at_place_m), force_N);
    });
    release_held(force_N);
  }

  // Conjugate gradients; `residual` and its `preconditioned` are there already.
  void solve_linearised() noexcept {
    work_.direction.setZero();
    work_.search = work_.preconditioned;
    double square = work_.residual.dot(work_.preconditioned);
    const double enough = kLinearlySolved * kLinearlySolved * square;
    for (int n = 0; n < tissue_.options_.linear_iterations_max && square > enough; ++n) {
      stiffness_times(work_.search, work_.product);
      const double curvature = work_.search.dot(work_.product);
      if (!(curvature > 0)) break;
      work_.direction += square / curvature * work_.search;
      work_.residual -= square / curvature * work_.product;
      precondition(work_.residual, work_.preconditioned);
      const double next = work_.residual.dot(work_.preconditioned);
      work_.search = work_.preconditioned + next / square * work_.search;
      square = next;
    }
  }

  bool search_along() noexcept {
    total_force(work_.residual);
    const double slope_J = work_.residual.dot(work_.direction);
    const double before_J = total_energy();
    if (!(slope_J > 0)) return false;
    double share = 1;
    for (int halving = 0; halving < kHalvingsMax; ++halving, share *= 0.5) {
      work_.trial = displacement_m_ + share * work_.direction;
      const double elastic_J = elastic(work_.trial, work_.trial_force);
      const double tie_J = place_ ? tie_energy(slid(work_.trial).square_m2) : 0;
      if (!(elastic_J + tie_J + energy_of_others(work_.trial) <= before_J - kWorthwhile * share * slope_J)) continue;
      displacement_m_ = work_.trial;
      work_.force.swap(work_.trial_force);
      elastic_J_ = elastic_J;
      return true;
    }
    return false;
  }

  struct Slid {
    SurfacePlace place;
    double square_m2 = 0;  // of the tie's length
  };

  // From the place to the nearest of those around, from triangle to triangle.
  template <typename Displacement>
  [[nodiscard]] Slid slid(const Displacement& displacement_m) const noexcept {
    Slid best{*place_, stretch(displacement_m, own_tie()).squaredNorm()};
    for (int hop = 0; hop < kHopsMax; ++hop) {
      const PlacesAround around = tissue_.surface_.places_around(best.place);
      const double before_m2 = best.square_m2;
      for (int k = 0; k < around.count; ++k) {
        const Eigen::Matrix3d here = corners(displacement_m, around.place[k].triangle);
        const Point weight = nearest_weights(here.col(0), here.col(1), here.col(2), probe_m_);
        const double square_m2 = (probe_m_ - here * weight).squaredNorm();
        if (square_m2 < best.square_m2) best = {{around.place[k].triangle, weight}, square_m2};
      }
      if (!(best.square_m2 < before_m2)) break;
    }
    return best;
  }

  [[nodiscard]] bool pulls(const CorotationalTie& tie) const noexcept {
    const Eigen::Matrix3d here = corners(displacement_m_, tie.place.triangle);
    const Point outward = (here.col(1) - here.col(0)).cross(here.col(2) - here.col(0));
    return stretch(displacement_m_, tie).dot(outward) >= 0;
  }

  // Away, where the tie would pull.
  void let_go() noexcept {
    for (CorotationalTie& other : others_) other.pulls = other.pulls || pulls(other);
    if (place_ && pulls(own_tie())) place_.reset();
  }

  void conclude() noexcept {
    total_force(work_.residual);
    estimate_residual();
    result_.converged = result_.residual_m <= tissue_.tolerance_m_;
    result_.energy_J = total_energy();
    if (!place_) {
      // At rest to within the tolerance is at rest: nothing is left to do in the steps to come.
      if (result_.converged && others_.empty() && displacement_m_.lpNorm<Eigen::Infinity>() <= tissue_.tolerance_m_) {
        displacement_m_.setZero();
        result_.energy_J = 0;
      }
      return;
    }
    result_.contacts = 1;
    result_.force_N = -tissue_.options_.contact_stiffness_N_per_m * stretch(displacement_m_, own_tie());
    result_.normal = result_.force_N.stableNormalized();
    result_.depth_m = std::max(0.0, (tissue_.surface_.at(*place_) - probe_m_).dot(result_.normal));
  }

  const CorotationalTissue& tissue_;
  Eigen::Map<Eigen::VectorXd> displacement_m_;
  CorotationalWorkspace& work_;
  Point probe_m_;
  std::span<CorotationalTie> others_;
  Point shift_m_ = Point::Zero();
  std::optional<SurfacePlace> place_;
  double elastic_J_ = 0;
  TissueResult result_;
};

TissueResult CorotationalTissue::step(TissueState& state, std::span<double> displacement_m,
                                      CorotationalWorkspace& workspace, const Point& probe_m,
                                      std::span<CorotationalTie> others) const noexcept {
  if (!probe_m.allFinite()) return {.finite = false};
  Step step(*this, displacement_m, workspace, probe_m, others);
  const TissueResult result = step.run(state);
  if (!result.force_N.allFinite() || !std::isfinite(result.energy_J)) return {.finite = false};
  state = step.state();
  return result;
}

}  // namespace forcebound::server
