#include "forcebound/tissue/tied_step.hpp"

#include <algorithm>

namespace forcebound::tissue {

TissueResult TiedStep::run(const TissueState& last) noexcept {
  find_shift(last);
  locate(last);
  if (!own_ && others_.empty() && body_.now.displacement_m.isZero(0)) return result_;
  for (SurfaceTie& other : others_) other.pulls = false;
  slide();
  // The tissue has not yet relaxed for the probe's new position: an apparent pull may be transient.
  body_.at_rest = false;
  (void)let_go();
  BodyRelaxation relaxation(setting_.elasticity, setting_.factors, body_, *this);
  for (;;) {
    result_.residual_m = relaxation.find_residual_m();
    if (result_.residual_m <= setting_.tolerance_m || result_.iterations == setting_.options.iterations_max) break;
    ++result_.iterations;
    if (!relaxation.improve(setting_.options.linear_iterations_max)) break;
    slide();
    if (own_) own_->balanced_m = surface().stretch_m(*own_);
  }
  body_.at_rest = result_.residual_m <= setting_.tolerance_m;
  if (let_go()) result_.residual_m = relaxation.find_residual_m();
  conclude(relaxation);
  return result_;
}

TissueState TiedStep::state() const noexcept {
  TissueState next{.started = 1,
                   .contacts = 0,
                   .probe_m = scene::to_array(probe_m_),
                   .shift_m = scene::to_array(shift_m_),
                   .direction = {},
                   .contact = {}};
  if (own_) next.contact[next.contacts++] = {own_->place.triangle, scene::to_array(own_->place.weight)};
  return next;
}

// Displacement of the surface near the probe: without contact the probe's position is mapped back to the tissue at
// rest. The nearest place depends on the displacement itself: a fixed-point iteration, continued from step to step.
void TiedStep::find_shift(const TissueState& last) noexcept {
  if (body_.now.displacement_m.isZero(0)) return;
  if (last.started != 0) shift_m_ = scene::to_point(last.shift_m);
  const SurfacePlace place =
      last.contacts > 0 ? place_of(last.contact[0]) : setting_.surface.nearest(probe_m_ - shift_m_).place;
  shift_m_ = surface().at(place) - setting_.surface.at(place);
}

void TiedStep::locate(const TissueState& last) noexcept {
  const std::optional<SurfacePlace> place = touched_place(setting_.surface, last, probe_m_ - shift_m_);
  if (!place) return;
  own_ = SurfaceTie{.place = *place, .probe_m = probe_m_, .slides = true};
  if (last.contacts > 0) own_->balanced_m = scene::to_point(last.probe_m) - surface().at(*place);
}

void TiedStep::slide() noexcept {
  if (own_) own_->place = surface().slid(*own_).place;
}

// All ties on the tissue.
template <typename Do>
void TiedStep::for_each_tie(const Do& act) const noexcept {
  if (own_) act(*own_);
  for (const SurfaceTie& other : others_) {
    if (!other.pulls) act(other);
  }
}

double TiedStep::energy_J(const Eigen::VectorXd& displacement_m) const noexcept {
  const DeformedSurface deformed(setting_.surface, displacement_m);
  double square_m2 = 0;
  for_each_tie([&](const SurfaceTie& tie) { square_m2 += deformed.slid(tie).square_m2; });
  return 0.5 * stiffness_N_per_m() * square_m2;
}

void TiedStep::add_forces(const Eigen::VectorXd& displacement_m, Eigen::VectorXd& force_N) const noexcept {
  const DeformedSurface deformed(setting_.surface, displacement_m);
  for_each_tie([&](const SurfaceTie& tie) {
    deformed.add_at(tie.place, stiffness_N_per_m() * deformed.stretch_m(tie), force_N);
  });
}

void TiedStep::linearise(const Eigen::VectorXd& /*displacement_m*/) noexcept {
  // Each tie has what it takes: see balanced_m.
}

void TiedStep::add_resistance(const Eigen::VectorXd& moved_m, Eigen::VectorXd& force_N) const noexcept {
  const DeformedSurface deformed = surface();
  for_each_tie([&](const SurfaceTie& tie) { deformed.add_resistance(tie, stiffness_N_per_m(), moved_m, force_N); });
}

// Removes the ties that would pull; returns whether any did. The probe's own tie is removed only while the tissue is at
// rest: a moving tissue, over several steps if it snaps through, may press the surface past a probe still in contact.
bool TiedStep::let_go() noexcept {
  const DeformedSurface deformed = surface();
  bool any = false;
  for (SurfaceTie& other : others_) {
    if (other.pulls || !deformed.pulls(other)) continue;
    any = other.pulls = true;
  }
  if (own_ && body_.at_rest && deformed.pulls(*own_)) {
    shift_m_ = deformed.at(own_->place) - setting_.surface.at(own_->place);
    own_.reset();
    any = true;
  }
  return any;
}

void TiedStep::conclude(BodyRelaxation& relaxation) noexcept {
  result_.converged = result_.residual_m <= setting_.tolerance_m;
  result_.energy_J = relaxation.energy_J();
  if (!own_) {
    if (result_.converged && others_.empty() && relaxation.settle(setting_.tolerance_m)) result_.energy_J = 0;
    return;
  }
  result_.contacts = 1;
  result_.force_N = -stiffness_N_per_m() * surface().stretch_m(*own_);
  result_.normal = result_.force_N.stableNormalized();
  result_.depth_m = std::max(0.0, (setting_.surface.at(own_->place) - probe_m_).dot(result_.normal));
}

}  // namespace forcebound::tissue
