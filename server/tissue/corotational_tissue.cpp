#include "forcebound/server/tissue/corotational_tissue.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr int kHalvingsMax = 8;           // of a line search
constexpr double kWorthwhile = 1e-4;      // share of the fall that the slope promises (Armijo)
constexpr double kLinearlySolved = 1e-2;  // of the first residual: Newton's method mends the rest

}  // namespace

void CorotationalOptions::check() const {
  const auto refuse = [](const std::string& what, double value) {
    throw std::invalid_argument(what + ", got " + text::to_text(value));
  };
  if (!(contact_stiffness_N_per_m > 0 && contact_stiffness_N_per_m <= kContactStiffnessMost_N_per_m)) {
    refuse("contact_stiffness_N_per_m must be > 0 and <= " + text::to_text(kContactStiffnessMost_N_per_m) +
               " under large motion",
           contact_stiffness_N_per_m);
  }
  if (iterations_max < 1) refuse("iterations_max must be >= 1", iterations_max);
  if (linear_iterations_max < 1) refuse("linear_iterations_max must be >= 1", linear_iterations_max);
  if (!(tolerance > 0 && tolerance < 1)) refuse("tolerance must be > 0 and < 1", tolerance);
}

CorotationalTissue::CorotationalTissue(TetrahedralMesh mesh, const ElasticMaterial& material,
                                       const std::vector<int>& held_nodes, const CorotationalOptions& options)
    : mesh_(std::move(mesh)),
      options_(options),
      surface_(mesh_.nodes_m(), mesh_.triangles()),
      elasticity_(mesh_, material),
      tolerance_m_(options.tolerance * mesh_.mean_edge_m()) {
  material.check();
  options_.check();
  const FreeCoordinates free(static_cast<int>(mesh_.nodes_m().size()), held_nodes);
  if (free.count() == 0) throw std::runtime_error(mesh_.name() + ": all nodes are held: expected some that can move");
  SparseCholesky cholesky;
  factorise(cholesky, free.reduced(stiffness_matrix(mesh_, material)), mesh_.name());
  factors_ = StiffnessFactors(cholesky, free);
}

std::size_t CorotationalTissue::memory_bytes() const noexcept {
  return elasticity_.memory_bytes() + factors_.memory_bytes() + surface_.nodes_m().size() * 3 * sizeof(Point) +
         surface_.triangles().size() * 2 * sizeof(TetrahedralMesh::Triangle) +
         mesh_.tetrahedra().size() * (sizeof(TetrahedralMesh::Tetrahedron) + sizeof(double));
}

std::size_t CorotationalBody::memory_bytes() const noexcept {
  constexpr std::size_t kVectors = 10;  // two in each DeformedBody, and the six here
  return kVectors * static_cast<std::size_t>(direction.size()) * sizeof(double) +
         linearised.size() * (2 * sizeof(PolarParts) + sizeof(LinearisedTetrahedron)) +
         turns.size() * sizeof(Eigen::Quaterniond);
}

CorotationalBody CorotationalTissue::make_body() const {
  const DeformedBody rest = elasticity_.at_rest();
  const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(rest.displacement_m.size());
  return {.now = rest,
          .trial = rest,
          .linearised = std::vector<LinearisedTetrahedron>(mesh_.tetrahedra().size()),
          .turns = std::vector<Eigen::Quaterniond>(mesh_.nodes_m().size(), Eigen::Quaterniond::Identity()),
          .direction = zeros,
          .residual = zeros,
          .preconditioned = zeros,
          .search = zeros,
          .product = zeros,
          .scratch = zeros};
}

void CorotationalTissue::deform(CorotationalBody& body, const Eigen::VectorXd& displacement_m) const noexcept {
  body.now.displacement_m = displacement_m;
  elasticity_.evaluate(body.now, body.now);
}

class CorotationalTissue::Step {
 public:
  Step(const CorotationalTissue& tissue, CorotationalBody& body, const Point& probe_m,
       std::span<SurfaceTie> others) noexcept
      : tissue_(tissue), body_(body), probe_m_(probe_m), others_(others) {}

  TissueResult run(const TissueState& last) noexcept {
    find_shift(last);
    locate(last);
    if (!own_ && others_.empty() && body_.now.displacement_m.isZero(0)) return result_;
    for (SurfaceTie& other : others_) other.pulls = false;
    slide();
    // The tissue is not yet where it is for the probe's new place: what seems to pull may be a step back on the way.
    body_.at_rest = false;
    (void)let_go();
    tissue_.elasticity_.find_turns(body_.now, body_.turns);
    for (;;) {
      find_residual();
      if (result_.residual_m <= tissue_.tolerance_m_ || result_.iterations == tissue_.options_.iterations_max) break;
      ++result_.iterations;
      solve_linearised();
      if (!search_along()) break;
      slide();
      if (own_) own_->balanced_m = surface().stretch_m(*own_);
    }
    body_.at_rest = result_.residual_m <= tissue_.tolerance_m_;
    if (let_go()) find_residual();
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
    if (own_) next.contact[next.contacts++] = {own_->place.triangle, to_array(own_->place.weight)};
    return next;
  }

 private:
  [[nodiscard]] DeformedSurface surface() const noexcept { return {tissue_.surface_, body_.now.displacement_m}; }
  [[nodiscard]] double stiffness_N_per_m() const noexcept { return tissue_.options_.contact_stiffness_N_per_m; }

  static SurfacePlace last_place(const TissueState& last) noexcept {
    return {.triangle = static_cast<int>(last.contact[0].triangle), .weight = to_point(last.contact[0].weight)};
  }

  // How far the surface near the probe has moved already: without contact the probe counts as where it would be beside
  // the tissue at rest. Which place is nearest depends on that: a fixed point, followed from step to step.
  void find_shift(const TissueState& last) noexcept {
    if (body_.now.displacement_m.isZero(0)) return;
    if (last.started != 0) shift_m_ = to_point(last.shift_m);
    const SurfacePlace place =
        last.contacts > 0 ? last_place(last) : tissue_.surface_.nearest(probe_m_ - shift_m_).place;
    shift_m_ = surface().at(place) - tissue_.surface_.at(place);
  }

  void locate(const TissueState& last) noexcept {
    std::optional<SurfacePlace> place;
    if (last.contacts > 0) {
      place = last_place(last);
    } else if (last.started != 0) {
      place = tissue_.surface_.entry(to_point(last.probe_m) - to_point(last.shift_m), probe_m_ - shift_m_);
    } else {
      const TissueSurface::Nearest nearest = tissue_.surface_.nearest(probe_m_ - shift_m_);
      if (nearest.height_m < 0) place = nearest.place;
    }
    if (!place) return;
    own_ = SurfaceTie{.place = *place, .probe_m = probe_m_, .slides = true};
    if (last.contacts > 0) own_->balanced_m = to_point(last.probe_m) - surface().at(*place);
  }

  void slide() noexcept {
    if (own_) own_->place = surface().slid(*own_).place;
  }

  // All that hold the tissue.
  template <typename Do>
  void for_each_tie(const Do& act) const noexcept {
    if (own_) act(*own_);
    for (const SurfaceTie& other : others_) {
      if (!other.pulls) act(other);
    }
  }

  [[nodiscard]] double energy_of_ties(const Eigen::VectorXd& displacement_m) const noexcept {
    const DeformedSurface deformed(tissue_.surface_, displacement_m);
    double square_m2 = 0;
    for_each_tie([&](const SurfaceTie& tie) { square_m2 += deformed.slid(tie).square_m2; });
    return 0.5 * stiffness_N_per_m() * square_m2;
  }

  [[nodiscard]] double energy_now() const noexcept {
    return body_.now.energy_J + energy_of_ties(body_.now.displacement_m);
  }

  void find_total_force() noexcept {
    body_.residual = body_.now.force_N;
    const DeformedSurface deformed = surface();
    for_each_tie([&](const SurfaceTie& tie) {
      deformed.add_at(tie.place, stiffness_N_per_m() * deformed.stretch_m(tie), body_.residual);
    });
  }

  // What is left of all forces on the nodes, and how far that would move them, were they as stiff as at rest.
  void find_residual() noexcept {
    find_total_force();
    precondition();
    result_.residual_m = body_.preconditioned.lpNorm<Eigen::Infinity>();
  }

  void precondition() noexcept {
    tissue_.factors_.solve(body_.turns, body_.residual, body_.preconditioned, body_.scratch);
  }

  // Conjugate gradients from the residual and what it is preconditioned to. What held nodes are pushed by is not looked
  // at, since they never move. Where the energy does not curve upwards, what is found so far still leads down.
  void solve_linearised() noexcept {
    tissue_.elasticity_.linearise(body_.now, body_.linearised);
    const DeformedSurface deformed = surface();
    body_.direction.setZero();
    body_.search = body_.preconditioned;
    double square = body_.residual.dot(body_.preconditioned);
    const double enough = kLinearlySolved * kLinearlySolved * square;
    for (int n = 0; n < tissue_.options_.linear_iterations_max && square > enough; ++n) {
      tissue_.elasticity_.resist(body_.linearised, body_.search, body_.product);
      for_each_tie([&](const SurfaceTie& tie) {
        deformed.add_resistance(tie, stiffness_N_per_m(), body_.search, body_.product);
      });
      const double curvature = body_.search.dot(body_.product);
      if (!(curvature > 0)) {
        if (n == 0) body_.direction = body_.search;
        break;
      }
      const double length = square / curvature;
      body_.direction += length * body_.search;
      body_.residual -= length * body_.product;
      precondition();
      const double next = body_.residual.dot(body_.preconditioned);
      body_.search = body_.preconditioned + next / square * body_.search;
      square = next;
    }
  }

  bool search_along() noexcept {
    find_total_force();
    const double slope_J = body_.residual.dot(body_.direction);
    if (!(slope_J > 0)) return false;
    const double before_J = energy_now();
    double share = 1;
    for (int halving = 0; halving < kHalvingsMax; ++halving, share *= 0.5) {
      body_.trial.displacement_m = body_.now.displacement_m + share * body_.direction;
      const double elastic_J_most =
          before_J - kWorthwhile * share * slope_J - energy_of_ties(body_.trial.displacement_m);
      if (!(elastic_J_most >= 0)) continue;
      tissue_.elasticity_.evaluate(body_.trial, body_.now);
      if (!(body_.trial.energy_J <= elastic_J_most)) continue;
      std::swap(body_.now, body_.trial);
      return true;
    }
    return false;
  }

  // Away, where the tie would pull; whether any was. The probe's own only while the tissue is at rest: on its way, over
  // more than one step where it snaps, it may press the surface past a probe that it does not leave.
  bool let_go() noexcept {
    const DeformedSurface deformed = surface();
    bool any = false;
    for (SurfaceTie& other : others_) {
      if (other.pulls || !deformed.pulls(other)) continue;
      any = other.pulls = true;
    }
    if (own_ && body_.at_rest && deformed.pulls(*own_)) {
      shift_m_ = deformed.at(own_->place) - tissue_.surface_.at(own_->place);
      own_.reset();
      any = true;
    }
    return any;
  }

  void conclude() noexcept {
    result_.converged = result_.residual_m <= tissue_.tolerance_m_;
    result_.energy_J = energy_now();
    if (!own_) {
      // At rest to within the tolerance is at rest: nothing is left to do in the steps to come.
      if (result_.converged && others_.empty() &&
          body_.now.displacement_m.lpNorm<Eigen::Infinity>() <= tissue_.tolerance_m_) {
        body_.now.displacement_m.setZero();
        tissue_.elasticity_.evaluate(body_.now, body_.now);
        result_.energy_J = 0;
      }
      return;
    }
    result_.contacts = 1;
    result_.force_N = -stiffness_N_per_m() * surface().stretch_m(*own_);
    result_.normal = result_.force_N.stableNormalized();
    result_.depth_m = std::max(0.0, (tissue_.surface_.at(own_->place) - probe_m_).dot(result_.normal));
  }

  const CorotationalTissue& tissue_;
  CorotationalBody& body_;
  Point probe_m_;
  std::span<SurfaceTie> others_;
  Point shift_m_ = Point::Zero();
  std::optional<SurfaceTie> own_;
  TissueResult result_;
};

TissueResult CorotationalTissue::step(TissueState& state, CorotationalBody& body, const Point& probe_m,
                                      std::span<SurfaceTie> others) const noexcept {
  if (!probe_m.allFinite()) return {.finite = false};
  Step step(*this, body, probe_m, others);
  const TissueResult result = step.run(state);
  if (!result.force_N.allFinite() || !std::isfinite(result.energy_J)) return {.finite = false};
  state = step.state();
  return result;
}

}  // namespace forcebound::server
