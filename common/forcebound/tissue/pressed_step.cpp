#include "forcebound/tissue/pressed_step.hpp"

#include <algorithm>

namespace forcebound::tissue {
namespace {

// Largest displacement of a node in one round, as a share of the radius, so that no place leaps through the sphere.
constexpr double kMoved = 0.5;

// The way out of a tissue is searched in this many steps: the first is kStepOut radii long, and each is kLonger times
// the one before, some 3800 radii in all.
constexpr int kStepsOut = 40;
constexpr double kStepOut = 0.125;
constexpr double kLonger = 1.25;

}  // namespace

TissueResult PressedStep::run(const TissueState& last) noexcept {
  const bool at_rest = others_m_.empty() && body_.now.displacement_m.isZero(0);
  if (at_rest && is_way_clear(setting_.surface, last, probe_m_, pressure_.radius_m())) {
    center_m_ = probe_m_;
    return result_;
  }
  center_m_ = last.started != 0 ? scene::to_point(last.probe_m) : outside();
  relax();
  return result_;
}

TissueState PressedStep::state() const noexcept {
  TissueState next{};
  next.started = 1;
  next.probe_m = scene::to_array(center_m_);
  return next;
}

// Assumed origin of a probe that begins in or close to the tissue: straight out from the nearest place.
scene::Point PressedStep::outside() const noexcept {
  const TissueSurface::Nearest nearest = setting_.surface.nearest(probe_m_);
  const bool inside = nearest.height_m < 0;
  scene::Point center_m = probe_m_;
  if (!inside && pressure_.touch(surface(), center_m).places == 0) return center_m;
  const scene::Point out = setting_.surface.triangle_normal(nearest.place.triangle);
  if (inside) center_m = setting_.surface.at(nearest.place) + pressure_.radius_m() * out;
  double step_m = kStepOut * pressure_.radius_m();
  for (int n = 0; n < kStepsOut && pressure_.touch(surface(), center_m).places > 0; ++n, step_m *= kLonger) {
    center_m += step_m * out;
  }
  return center_m;
}

// Moves the sphere towards the probe as far as the tissue leaves room now. True if it moved by more than the tolerance,
// or arrived.
bool PressedStep::advance() noexcept {
  if (arrived()) return false;
  const double share = pressure_.free_share(surface(), center_m_, probe_m_);
  if (share == 1) {
    center_m_ = probe_m_;
    return true;
  }
  const scene::Point way_m = share * (probe_m_ - center_m_);
  center_m_ += way_m;
  return way_m.norm() > setting_.tolerance_m;
}

void PressedStep::relax() noexcept {
  BodyRelaxation relaxation(setting_.elasticity, setting_.factors, body_, *this);
  const CorotationalOptions& options = setting_.options;
  for (;;) {
    // In the last round the sphere stays where the tissue has already relaxed.
    const bool goes_on = result_.iterations < options.iterations_max && advance() && !arrived();
    result_.residual_m = relaxation.find_residual_m();
    if (result_.iterations == options.iterations_max) break;
    if (result_.residual_m <= setting_.tolerance_m && !goes_on) break;
    ++result_.iterations;
    if (!relaxation.improve(options.linear_iterations_max, kMoved * pressure_.radius_m()) && !goes_on) break;
  }
  conclude(relaxation);
}

// All spheres on the tissue.
template <typename Do>
void PressedStep::for_each_sphere(const Do& act) const noexcept {
  act(center_m_);
  for (const scene::Point& other_m : others_m_) act(other_m);
}

double PressedStep::energy_J(const Eigen::VectorXd& displacement_m) const noexcept {
  const DeformedSurface deformed(setting_.surface, displacement_m);
  double energy_J = 0;
  for_each_sphere([&](const scene::Point& center_m) { energy_J += pressure_.energy_J(deformed, center_m); });
  return energy_J;
}

void PressedStep::add_forces(const Eigen::VectorXd& displacement_m, Eigen::VectorXd& force_N) const noexcept {
  const DeformedSurface deformed(setting_.surface, displacement_m);
  for_each_sphere([&](const scene::Point& center_m) { pressure_.add_forces(deformed, center_m, force_N); });
}

void PressedStep::linearise(const Eigen::VectorXd& displacement_m) noexcept {
  const DeformedSurface deformed(setting_.surface, displacement_m);
  body_.pressed.clear();
  for_each_sphere([&](const scene::Point& center_m) { pressure_.add_resistance(deformed, center_m, body_.pressed); });
}

void PressedStep::add_resistance(const Eigen::VectorXd& moved_m, Eigen::VectorXd& force_N) const noexcept {
  const DeformedSurface deformed = surface();
  for (std::size_t n = 0; n < body_.pressed.count; ++n) {
    const int triangle = body_.pressed.touched[n];
    const Eigen::Matrix3d corners_moved_m = deformed.corners_of(triangle, moved_m);
    Eigen::Matrix3d resisted_N;
    resisted_N.reshaped() = body_.pressed.resistance[triangle] * corners_moved_m.reshaped();
    deformed.add_to_corners(triangle, resisted_N, force_N);
  }
}

void PressedStep::conclude(BodyRelaxation& relaxation) noexcept {
  const SpherePressure::Touch touch = pressure_.touch(surface(), center_m_);
  result_.converged = result_.residual_m <= setting_.tolerance_m && arrived();
  result_.energy_J = relaxation.energy_J();
  body_.at_rest = result_.converged;
  result_.contacts = touch.places;
  if (touch.places > 0) {
    result_.force_N = touch.force_N;
    result_.normal = touch.force_N.stableNormalized();
    result_.depth_m = std::max(0.0, pressure_.depth_at_rest_m(surface(), center_m_, result_.normal));
  } else if (result_.converged && energy_J(body_.now.displacement_m) == 0 && relaxation.settle(setting_.tolerance_m)) {
    result_.energy_J = 0;
  }
}

}  // namespace forcebound::tissue
