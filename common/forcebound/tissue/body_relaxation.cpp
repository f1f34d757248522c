#include "forcebound/tissue/body_relaxation.hpp"

#include <algorithm>
#include <utility>

namespace forcebound::tissue {
namespace {

constexpr int kHalvingsMax = 8;           // of a line search
constexpr double kWorthwhile = 1e-4;      // share of the fall predicted by the slope (Armijo)
constexpr double kLinearlySolved = 1e-2;  // of the first residual: Newton's method reduces the rest

}  // namespace

std::size_t CorotationalBody::memory_bytes() const noexcept {
  constexpr std::size_t kVectors = 10;  // two in each DeformedBody, and the six here
  return kVectors * static_cast<std::size_t>(direction.size()) * sizeof(double) +
         linearised.frames.size() * (2 * sizeof(PolarParts) + sizeof(LinearisedBody::Frame)) +
         static_cast<std::size_t>(linearised.places_m.size() + linearised.pushes_N.size()) * sizeof(double) +
         turns.size() * sizeof(Eigen::Quaterniond) + pressed.memory_bytes();
}

BodyRelaxation::BodyRelaxation(const CorotationalElasticity& elasticity, const StiffnessFactors& factors,
                               CorotationalBody& body, BodyContact& contact) noexcept
    : elasticity_(elasticity), factors_(factors), body_(body), contact_(contact) {
  elasticity_.find_turns(body_.now, body_.turns);
}

void BodyRelaxation::find_total_force() noexcept {
  body_.residual = body_.now.force_N;
  contact_.add_forces(body_.now.displacement_m, body_.residual);
}

double BodyRelaxation::find_residual_m() noexcept {
  find_total_force();
  precondition();
  return body_.preconditioned.lpNorm<Eigen::Infinity>();
}

void BodyRelaxation::precondition() noexcept {
  factors_.solve(body_.turns, body_.residual, body_.preconditioned, body_.scratch);
}

bool BodyRelaxation::improve(int linear_iterations_max, double moved_m_most) noexcept {
  solve_linearised(linear_iterations_max);
  const double moved_m = body_.direction.lpNorm<Eigen::Infinity>();
  return search_along(moved_m > moved_m_most ? moved_m_most / moved_m : 1);
}

// Conjugate gradients from the residual and its preconditioned form. Forces on held nodes are ignored, since these
// never move. Where the energy does not curve upwards, the direction found so far still leads down.
void BodyRelaxation::solve_linearised(int iterations_max) noexcept {
  elasticity_.linearise(body_.now, body_.linearised);
  contact_.linearise(body_.now.displacement_m);
  body_.direction.setZero();
  body_.search = body_.preconditioned;
  double square = body_.residual.dot(body_.preconditioned);
  const double enough = kLinearlySolved * kLinearlySolved * square;
  for (int n = 0; n < iterations_max && square > enough; ++n) {
    elasticity_.resist(body_.linearised, body_.search, body_.product);
    contact_.add_resistance(body_.search, body_.product);
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

bool BodyRelaxation::search_along(double share) noexcept {
  find_total_force();
  const double slope_J = body_.residual.dot(body_.direction);
  if (!(slope_J > 0)) return false;
  const double before_J = energy_J();
  for (int halving = 0; halving < kHalvingsMax; ++halving, share *= 0.5) {
    body_.trial.displacement_m = body_.now.displacement_m + share * body_.direction;
    const double elastic_J_most =
        before_J - kWorthwhile * share * slope_J - contact_.energy_J(body_.trial.displacement_m);
    if (!(elastic_J_most >= 0)) continue;
    elasticity_.evaluate(body_.trial, body_.now);
    if (!(body_.trial.energy_J <= elastic_J_most)) continue;
    std::swap(body_.now, body_.trial);
    return true;
  }
  return false;
}

bool BodyRelaxation::settle(double tolerance_m) noexcept {
  if (body_.now.displacement_m.lpNorm<Eigen::Infinity>() > tolerance_m) return false;
  body_.now.displacement_m.setZero();
  elasticity_.evaluate(body_.now, body_.now);
  return true;
}

}  // namespace forcebound::tissue
