#include "forcebound/client/rendering/answer_rendering.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "forcebound/client/rendering/linear_field.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::client {
namespace {

constexpr Eigen::Index kTranslations = 3;
// A pause in the ticks longer than this says nothing about how fast the device is.
constexpr double kPauseMost_s = 0.1;
// Of the held force: less is rounding, since models travel with 24 bits.
constexpr double kNothing_N = 1e-5;

Vector in_rows(const Point& point, Eigen::Index rows) noexcept {
  Vector vector = Vector::Zero(rows);
  const Eigen::Index translations = std::min(rows, kTranslations);
  vector.head(translations) = point.head(translations);
  return vector;
}

}  // namespace

void AnswerRendering::forget_models() noexcept {
  model_ = {};
  for (SurfaceContact& surface : surfaces_) surface.forget();
  mass_.forget();
  fading_N_.setZero();
}

/// The device's place and velocity on this tick.
void AnswerRendering::look(const Tick& tick) noexcept {
  const Point place_m = control::translation_of(tick.place);
  elapsed_s_ = looked_ ? time::to_seconds(tick.now - last_) : 0;
  if (!(elapsed_s_ > 0 && elapsed_s_ <= kPauseMost_s)) elapsed_s_ = 0;
  device_.velocity_m_per_s.setZero();
  if (elapsed_s_ > 0) device_.velocity_m_per_s = (place_m - device_.place_m) / elapsed_s_;
  device_.place_m = place_m;
  looked_ = true;
  last_ = tick.now;
}

void AnswerRendering::advance(const ModelAge& age, Nanoseconds now) noexcept {
  for (std::uint32_t i = 0; i < model_.surface_count; ++i) surfaces_.at(i).advance(device_, age, elapsed_s_);
  mass_.advance(device_, elapsed_s_, now, share_);
  fading_N_ *= std::exp(-elapsed_s_ / kFade_s);
}

Point AnswerRendering::held_N(bool server_parts_alone) const noexcept {
  return control::translation_of(server_parts_alone ? server_parts_N_ : force_N_);
}

/// What the device can show of an answer with its models. What fades is added to that: then a force beyond it, as of a
/// model that went on through a blackout, does not come at once.
Point AnswerRendering::shown_N(const Sum& sum, double share, const Tick& tick) const noexcept {
  const Point all_N = share * held_N(tick.server_parts_alone) + sum.correction_N;
  return local_model::no_longer_than(all_N, tick.force_N_max);
}

AnswerRendering::Sum AnswerRendering::sum(const ModelAge& age, double share) const noexcept {
  Sum all;
  const bool goes_on = ended_ != session_;
  bool comparable = true;
  const auto add = [&](double holds, bool still, const Point& force, const Point& in_its_place) {
    if (!(holds > 0)) return;
    all.foretells = true;
    all.foretold_N += holds * (force - in_its_place);
    const double weight = foresight_.trust() * holds;
    const bool stands = still && goes_on;
    const double own_share = stands ? 1 : share;
    all.stands = all.stands && stands;
    if (own_share > 0) all.weight = std::max(all.weight, weight);
    all.correction_N += weight * (own_share * force - share * in_its_place);
    all.model_N += weight * own_share * force;
    all.replaced_N += weight * in_its_place;
  };
  for (std::uint32_t i = 0; i < model_.surface_count; ++i) {
    const SurfaceContact& surface = surfaces_.at(i);
    // Friction is the client's alone, and no part of what an answer tells.
    comparable = comparable && model_.surfaces.at(i).friction == 0;
    add(surface.weight(device_, age), surface.stands(), surface.force_N(device_, age), surface.held_N());
  }
  if (model_.has_mass) {
    add(mass_.weight(device_), mass_.is_the_devices_own(), mass_.force_N(device_), mass_.held_N());
    all.stands = all.stands && mass_.stands();
  }
  if (model_.has_field) add(weight(model_.field, device_), false, force_N(model_.field, device_), model_.field.force_N);
  all.foretells = all.foretells && comparable;
  return all;
}

double AnswerRendering::least_radius_m() const noexcept {
  double least_m = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < model_.surface_count; ++i) least_m = std::min(least_m, model_.surfaces.at(i).radius_m);
  if (model_.has_mass) least_m = std::min(least_m, model_.mass.radius_m);
  if (model_.has_field) least_m = std::min(least_m, model_.field.radius_m);
  return least_m;
}

void AnswerRendering::store_answer(const wire::EnvironmentForce& newest, const Tick& tick) noexcept {
  sequence_ = newest.motion_sequence;
  session_ = newest.session;
  force_N_ = newest.answer.force;
  server_parts_N_ = newest.answer.server_parts_N;
  const bool sound = local_model::is_sound(newest.answer.model);
  if (!sound) ++refused_;
  model_ = sound ? newest.answer.model : local_model::LocalModel{};
  // What relaxes goes on with its surface, whose place in the list may be another.
  const auto before = surfaces_;
  for (std::uint32_t k = 0; k < surfaces_.size(); ++k) {
    surfaces_.at(k).forget();
    if (k >= model_.surface_count) continue;
    const local_model::Surface& told = model_.surfaces.at(k);
    const auto same = std::ranges::find_if(before, [&](const SurfaceContact& one) { return one.is(told.id); });
    if (same != before.end()) surfaces_.at(k) = *same;
    surfaces_.at(k).update(told, device_, tick.age);
  }
  if (model_.has_mass) {
    mass_.update(model_.mass, tick.age, tick.now);
  } else {
    mass_.forget();
  }
}

/// A mass that has caught up takes its place; what that changes fades.
void AnswerRendering::fade_over_to_mass(const ModelAge& age, const Tick& tick) noexcept {
  const Point before_N = shown_N(sum(age, share_), share_, tick);
  mass_.take_its_place();
  const Point change_N = before_N - shown_N(sum(age, share_), share_, tick);
  if (change_N.allFinite()) fading_N_ += change_N;
}

/// What differs between both fades. Returns what the newest asks for.
AnswerRendering::Sum AnswerRendering::go_over_to(const wire::EnvironmentForce& newest, const Tick& tick,
                                                 const ModelAge& age_before, double share_before) noexcept {
  const bool first = sequence_ == 0;
  const bool modelled = !model_.empty();
  const Point until_now_N = shown_N(sum(age_before, share_before), share_before, tick) + fading_N_;
  const bool goes_on = until_now_N.allFinite();
  if (!goes_on) {
    // That is the fault of the answer before, of which nothing is left for the newest.
    refused_ += modelled ? 1 : 0;
    forget_models();
  }
  store_answer(newest, tick);
  foresight_.compare(tick.now - time::from_seconds(tick.age.s), held_N(tick.server_parts_alone));
  const Sum next = sum(tick.age, tick.share);
  if (!first && goes_on && (modelled || !model_.empty())) fading_N_ = until_now_N - shown_N(next, tick.share, tick);
  return next;
}

AnswerRendering::Rendered AnswerRendering::render(const wire::EnvironmentForce& newest, const Tick& tick) noexcept {
  look(tick);
  const bool another = newest.motion_sequence != sequence_;
  // What was rendered until now goes on from its own age, which may have stood still.
  const ModelAge age = another ? ModelAge{age_.s + elapsed_s_, age_.uncertain_s} : tick.age;
  age_ = tick.age;
  advance(age, tick.now);
  if (mass_.has_caught_up()) fade_over_to_mass(age, tick);
  const double share_before = std::exchange(share_, tick.share);
  const Sum now = another ? go_over_to(newest, tick, age, share_before) : sum(tick.age, tick.share);
  const Point held_now_N = held_N(tick.server_parts_alone);
  foresight_.remember(
      {.time = tick.now, .modelled = now.foretells, .modelled_N = held_now_N + now.foretold_N, .held_N = held_now_N});
  Point correction_N = now.correction_N;
  if (!model_.empty() || !fading_N_.isZero(0)) {
    const Point all_N = tick.share * held_now_N + now.correction_N;
    correction_N += fading_N_;
    if (all_N.allFinite()) correction_N += shown_N(now, tick.share, tick) - all_N;
  }
  const Eigen::Index rows = tick.place.rows();
  if (!correction_N.allFinite()) {
    ++refused_;
    // Not again before the next answer.
    forget_models();
    return {.correction_N = Vector::Zero(rows), .held = true};
  }
  const Vector& held = tick.server_parts_alone ? server_parts_N_ : force_N_;
  const bool whole = held.rows() == 0 || (held - in_rows(now.replaced_N, held.rows())).norm() <= kNothing_N;
  Rendered rendered{.correction_N = in_rows(correction_N, rows), .held = tick.share > 0 && !whole};
  if (now.weight > 0) rendered.model_N = in_rows(now.model_N, rows);
  rendered.fades = model_.empty() ? held.rows() > 0 : !(whole && now.stands);
  if (!model_.empty()) rendered.trust = foresight_.trust();
  if (model_.has_mass) rendered.deviation_m = mass_.deviation_m();
  return rendered;
}

}  // namespace forcebound::client
