#include "forcebound/local_model/mass_step.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::local_model {
namespace {

constexpr int kSweeps = 6;

/// A body in one step: its velocity at the step's end, and what an impulse adds to that.
struct Moving {
  Point velocity_m_per_s;
  Eigen::Matrix3d per_kg;
  double most_per_kg;  // no eigenvalue is larger

  void push(const Point& impulse_Ns) noexcept { velocity_m_per_s += per_kg * impulse_Ns; }
};

/// Without contacts and dry friction. @param more_N_s_per_m, pulled_N of what else acts at the step's end: pulled_N
/// less more_N_s_per_m times the velocity then
Moving moving(const Body& body, const Point& velocity_m_per_s, const Point& moved_m, double step_s, double share,
              const Point& pulled_N = Point::Zero(), double more_N_s_per_m = 0) noexcept {
  if (body.mobility_per_kg.isZero(0))
    return {.velocity_m_per_s = Point::Zero(), .per_kg = Eigen::Matrix3d::Zero(), .most_per_kg = 0};
  const double damped_kg = step_s * (body.damper_N_s_per_m + step_s * body.spring_N_per_m + more_N_s_per_m);
  const Eigen::Matrix3d& free_per_kg = body.mobility_per_kg;
  const Eigen::Matrix3d kept = (Eigen::Matrix3d::Identity() + damped_kg * free_per_kg).inverse();
  const Point impulse_Ns = step_s * (pulled_N - body.spring_N_per_m * moved_m);
  const Eigen::Matrix3d per_kg = kept * free_per_kg;
  return {.velocity_m_per_s = kept * (velocity_m_per_s + step_s * share * body.bias_m_per_s2) + per_kg * impulse_Ns,
          .per_kg = per_kg,
          .most_per_kg = per_kg.cwiseAbs().rowwise().sum().maxCoeff()};
}

void rub(double most_Ns, Point& impulse_Ns, Moving& body) noexcept {
  if (!(body.most_per_kg > 0) || (most_Ns == 0 && impulse_Ns.isZero(0))) return;
  const Point before_Ns = impulse_Ns;
  impulse_Ns = no_longer_than<Point>(impulse_Ns - body.velocity_m_per_s / body.most_per_kg, most_Ns);
  body.push(impulse_Ns - before_Ns);
}

/// What a contact asks of the velocities at the step's end.
struct Target {
  bool touches = false;
  double along_m_per_s = 0;
  double along_per_kg = 0;  ///< its compliance along its normal, and beside it
  double beside_per_kg = 0;
  Point beside_m_per_s = Point::Zero();
};

/// Nothing where it ends.
Target target(const Contact& contact, MassState::Met& met, const Point& moved_m, const Point& relative_m_per_s,
              double step_s) noexcept {
  const Point slid_m = moved_m - met.moved_m;
  const bool is_there = (slid_m - slid_m.dot(contact.normal) * contact.normal).norm() <= contact.radius_m;
  if (!(met.gap_m < 0)) return {};
  if (!is_there) met.gap_m = std::numeric_limits<double>::infinity();
  if (!is_there) return {};
  const double beside = 1 + step_s * contact.damping_per_s;
  const double along = beside + step_s * step_s * contact.stiffness_per_s2;
  const double speed_m_per_s = contact.normal.dot(relative_m_per_s);
  return {.touches = true,
          .along_m_per_s = (speed_m_per_s - step_s * contact.stiffness_per_s2 * met.gap_m) / along,
          .along_per_kg = contact.compliance_per_kg / along,
          .beside_per_kg = contact.compliance_per_kg / beside,
          .beside_m_per_s = (relative_m_per_s - speed_m_per_s * contact.normal) / beside};
}

void press(const Contact& contact, const Target& target, MassState::Met& met, Moving& mass, Moving& body) noexcept {
  const Point& normal = contact.normal;
  const auto apply = [&](const Point& impulse_Ns) {
    mass.push(impulse_Ns);
    body.push(-impulse_Ns);
  };
  const auto relative = [&] { return Point(mass.velocity_m_per_s - body.velocity_m_per_s); };
  const double along_per_kg = normal.dot((mass.per_kg + body.per_kg) * normal) + target.along_per_kg;
  if (!(along_per_kg > 0)) return;
  const double before_Ns = met.pressed_Ns;
  const double wanted = target.along_m_per_s - normal.dot(relative()) - target.along_per_kg * before_Ns;
  met.pressed_Ns = std::max(0.0, before_Ns + wanted / along_per_kg);
  apply((met.pressed_Ns - before_Ns) * normal);
  const double beside_per_kg = mass.most_per_kg + body.most_per_kg + target.beside_per_kg;
  const Point rubbed_Ns = met.rubbed_Ns;
  const Point slip = relative() - normal * normal.dot(relative());
  const Point stuck_Ns = rubbed_Ns + (target.beside_m_per_s - slip - target.beside_per_kg * rubbed_Ns) / beside_per_kg;
  met.rubbed_Ns = no_longer_than<Point>(stuck_Ns, contact.friction * met.pressed_Ns);
  apply(met.rubbed_Ns - rubbed_Ns);
}

/// Neither beyond its travel nor its return.
void stop(const Contact& contact, double step_s, MassState::Met& met, Moving& body) noexcept {
  if (std::isinf(contact.travel_m) && std::isinf(contact.return_m)) return;
  const double along_per_kg = contact.normal.dot(body.per_kg * contact.normal);
  if (!(along_per_kg > 0)) return;
  const double moved_m = contact.normal.dot(met.moved_m);
  const double least = std::min(0.0, -(contact.travel_m + moved_m) / step_s);
  const double most = std::max(0.0, (contact.return_m - moved_m) / step_s);
  const double before_Ns = met.stopped_Ns;
  // Without that impulse.
  const double free = contact.normal.dot(body.velocity_m_per_s) - along_per_kg * before_Ns;
  met.stopped_Ns = (std::clamp(free, least, most) - free) / along_per_kg;
  body.push((met.stopped_Ns - before_Ns) * contact.normal);
}

}  // namespace

MassState state_of(const Mass& told) noexcept {
  MassState state{.place_m = told.place_m,
                  .velocity_m_per_s = no_longer_than(told.body.velocity_m_per_s, Mass::kSpeedMost_m_per_s)};
  for (std::uint32_t i = 0; i < told.contact_count; ++i) {
    const Contact& contact = told.contacts.at(i);
    state.met.at(i).gap_m = contact.gap_m;
    state.met.at(i).velocity_m_per_s = no_longer_than(contact.met.velocity_m_per_s, Mass::kSpeedMost_m_per_s);
  }
  return state;
}

Point pull_N(const Mass& mass, const MassState& state, const DevicePoint& device) noexcept {
  return mass.stiffness_N_per_m * no_longer_than<Point>(device.place_m - state.place_m, Mass::kReachMost_m) +
         mass.damping_N_s_per_m *
             (no_longer_than(device.velocity_m_per_s, Mass::kSpeedMost_m_per_s) - state.velocity_m_per_s);
}

void step(const Mass& mass, const DevicePoint& device, double step_s, double share, MassState& state) noexcept {
  const Point moved_m = state.place_m - mass.place_m;
  // At the step's end, of a mass that does not move until then.
  const Point pulled_N = pull_N(mass, state, device) + mass.damping_N_s_per_m * state.velocity_m_per_s;
  Moving moved = moving(mass.body, state.velocity_m_per_s, moved_m, step_s, share, pulled_N,
                        mass.damping_N_s_per_m + step_s * mass.stiffness_N_per_m);
  moved.push(state.dry_Ns);
  std::array<Moving, Mass::kContactsMax> bodies;
  std::array<Target, Mass::kContactsMax> targets;
  for (std::uint32_t i = 0; i < mass.contact_count; ++i) {
    const Contact& contact = mass.contacts.at(i);
    MassState::Met& met = state.met.at(i);
    targets.at(i) = target(contact, met, moved_m, state.velocity_m_per_s - met.velocity_m_per_s, step_s);
    bodies.at(i) = moving(contact.met, met.velocity_m_per_s, met.moved_m, step_s, share);
    if (!targets.at(i).touches) met.pressed_Ns = 0;
    if (!targets.at(i).touches) met.rubbed_Ns.setZero();
    const Point contact_Ns = met.pressed_Ns * contact.normal + met.rubbed_Ns;
    moved.push(contact_Ns);
    bodies.at(i).push(met.dry_Ns + met.stopped_Ns * contact.normal - contact_Ns);
  }
  const bool alone = mass.contact_count == 0 && mass.body.dry_friction_N == 0;
  for (int sweep = 0; sweep < (alone ? 0 : kSweeps); ++sweep) {
    rub(step_s * mass.body.dry_friction_N, state.dry_Ns, moved);
    for (std::uint32_t i = 0; i < mass.contact_count; ++i) {
      const Contact& contact = mass.contacts.at(i);
      rub(step_s * contact.met.dry_friction_N, state.met.at(i).dry_Ns, bodies.at(i));
      stop(contact, step_s, state.met.at(i), bodies.at(i));
      if (targets.at(i).touches) press(contact, targets.at(i), state.met.at(i), moved, bodies.at(i));
    }
  }
  state.velocity_m_per_s = no_longer_than(moved.velocity_m_per_s, Mass::kSpeedMost_m_per_s);
  state.place_m += step_s * state.velocity_m_per_s;
  for (std::uint32_t i = 0; i < mass.contact_count; ++i) {
    MassState::Met& met = state.met.at(i);
    met.velocity_m_per_s = no_longer_than(bodies.at(i).velocity_m_per_s, Mass::kSpeedMost_m_per_s);
    met.moved_m += step_s * met.velocity_m_per_s;
    met.received_Ns -= met.pressed_Ns * mass.contacts.at(i).normal + met.rubbed_Ns;
    met.gap_m += step_s * mass.contacts.at(i).normal.dot(state.velocity_m_per_s - met.velocity_m_per_s);
  }
}

}  // namespace forcebound::local_model
