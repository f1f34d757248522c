#include "tests/tools/lab/soak/lying_model.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace forcebound::lab {
namespace {

using local_model::LocalModel;
using local_model::Point;
using sim::Draw;

Point place_near(Draw& draw, const wire::EnvironmentForce& answer) {
  const double size_m = draw.one_of({1e-4, 1e-4, 0.01, 0.01, 0.3, 100.0});
  Point place_m = draw.vector(3, size_m);
  const Eigen::Index rows = std::min<Eigen::Index>(answer.position.rows(), 3);
  place_m.head(rows) += answer.position.head(rows);
  return place_m;
}

/// Of a part of the answer's force: up to what no device gives.
Point lying_force_N(Draw& draw) { return draw.vector(3, draw.one_of({0.0, 1.0, 1e3, 5e5})); }

Eigen::Matrix3d matrix_between_zero_and(Draw& draw, double most) {
  const Point along = draw.direction(3, 1);
  const Eigen::Matrix3d flat = along * along.transpose();
  return draw.chance(0.5) ? Eigen::Matrix3d(most * flat) : Eigen::Matrix3d(most * Eigen::Matrix3d::Identity());
}

local_model::Surface lying_surface(Draw& draw, const wire::EnvironmentForce& answer) {
  local_model::Surface surface;
  surface.id = static_cast<std::uint32_t>(draw.index(3));
  surface.force_N = lying_force_N(draw);
  surface.place_m = place_near(draw, answer);
  surface.normal = draw.direction(3, 1);
  surface.stiffness_N_per_m = matrix_between_zero_and(draw, draw.one_of({1e2, 1e4, 1e6, 9e6}));
  surface.damping_N_s_per_m = draw.one_of({0.0, 10.0, 9e4});
  surface.velocity_m_per_s = draw.vector(3, draw.one_of({0.0, 0.1, 50.0}));
  surface.acceleration_m_per_s2 = draw.vector(3, draw.one_of({0.0, 10.0, 5e3}));
  surface.relaxing_N_per_m = draw.one_of({0.0, 1e3, 9e6});
  surface.relaxation_s = draw.one_of({1e-3, 0.1, 100.0});
  // Without a spring that relaxes it is unsound, and all of the model with it.
  if (surface.relaxing_N_per_m > 0 || draw.chance(0.02))
    surface.relaxed_N = draw.number(-1, 1) * draw.one_of({1.0, 1e3, 9e5});
  surface.friction = draw.one_of({0.0, 0.5, 90.0});
  surface.radius_m = draw.one_of({1e-3, 0.05, 100.0});
  surface.others_move_it = draw.chance(0.5);
  return surface;
}

local_model::Body lying_body(Draw& draw, double mass_kg) {
  return {.velocity_m_per_s = draw.vector(3, draw.one_of({0.0, 0.5, 50.0})),
          .bias_m_per_s2 = draw.vector(3, draw.one_of({0.0, 10.0, 5e3})),
          .mobility_per_kg = matrix_between_zero_and(draw, draw.one_of({0.0, 0.1, 1.0}) / mass_kg),
          .spring_N_per_m = draw.one_of({0.0, 400.0, 9e6}),
          .damper_N_s_per_m = draw.one_of({0.0, 4.0, 9e4}),
          .dry_friction_N = draw.one_of({0.0, 3.0, 9e5})};
}

local_model::Contact lying_contact(Draw& draw) {
  local_model::Contact contact{.normal = draw.direction(3, 1),
                               .gap_m = draw.one_of({-0.9, -1e-3, 0.0, 0.02}),
                               .compliance_per_kg = draw.one_of({0.0, 1.0, 9e5}),
                               .stiffness_per_s2 = draw.one_of({0.0, 6e4, 9e8}),
                               .damping_per_s = draw.one_of({0.0, 500.0, 9e4}),
                               .friction = draw.one_of({0.0, 0.5, 90.0})};
  if (draw.chance(0.5)) contact.radius_m = draw.one_of({1e-6, 5e-3, 100.0});
  if (draw.chance(0.5)) contact.travel_m = draw.one_of({0.0, 1e-3, 0.1});
  if (draw.chance(0.5)) contact.return_m = draw.one_of({0.0, 1e-3, 0.1});
  if (draw.chance(0.7)) contact.met = lying_body(draw, draw.one_of({2e-4, 0.03, 10.0}));
  return contact;
}

local_model::Mass lying_mass(Draw& draw, const wire::EnvironmentForce& answer) {
  local_model::Mass mass;
  mass.id = static_cast<std::uint32_t>(draw.index(2));
  mass.force_N = lying_force_N(draw);
  mass.place_m = place_near(draw, answer);
  const double mass_kg = draw.one_of({2e-4, 0.03, 10.0});
  mass.stiffness_N_per_m = mass_kg * draw.one_of({1e3, 1e5, 1e7});
  mass.damping_N_s_per_m = mass_kg * draw.one_of({0.0, 10.0, 5e3});
  mass.body = lying_body(draw, mass_kg);
  mass.contact_count = static_cast<std::uint32_t>(draw.index(local_model::Mass::kContactsMax + 1));
  for (std::uint32_t i = 0; i < mass.contact_count; ++i) mass.contacts.at(i) = lying_contact(draw);
  mass.radius_m = draw.one_of({1e-3, 0.4, 100.0});
  mass.others_move_it = draw.chance(0.5);
  return mass;
}

local_model::Field lying_field(Draw& draw, const wire::EnvironmentForce& answer) {
  local_model::Field field;
  field.force_N = lying_force_N(draw);
  field.place_m = place_near(draw, answer);
  for (Eigen::Index column = 0; column < 3; ++column)
    field.jacobian_N_per_m.col(column) = draw.vector(3, draw.one_of({0.0, 1e3, 9e6}));
  field.radius_m = draw.one_of({1e-3, 0.05, 100.0});
  return field;
}

/// Puts a number somewhere that cannot be there.
void spoil_model(Draw& draw, LocalModel& model) {
  const double bad =
      draw.one_of({std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e12, 1e12});
  switch (draw.index(5)) {
    case 0:
      model.surfaces[0].stiffness_N_per_m(1, 1) = bad;
      break;
    case 1:
      model.surfaces[0].place_m.x() = bad;
      break;
    case 2:
      model.mass.body.mobility_per_kg(1, 1) = bad;
      break;
    case 3:
      model.surfaces[0].friction = bad;
      break;
    default:
      model.field.jacobian_N_per_m(2, 0) = bad;
  }
}

}  // namespace

local_model::LocalModel lying_model(Draw& draw, const wire::EnvironmentForce& answer) {
  LocalModel model;
  model.by_device_clock = draw.chance(0.5);
  if (draw.chance(0.3)) {
    constexpr std::chrono::nanoseconds kMost = LocalModel::kBeforeReadingMost;
    model.before_reading = draw.one_of({-kMost, kMost, kMost / 100, 2 * kMost});
  }
  model.surface_count = static_cast<std::uint32_t>(draw.index(LocalModel::kSurfacesMax + 1));
  for (std::uint32_t i = 0; i < model.surface_count; ++i) model.surfaces.at(i) = lying_surface(draw, answer);
  model.has_mass = draw.chance(0.5);
  if (model.has_mass) model.mass = lying_mass(draw, answer);
  model.has_field = draw.chance(0.3);
  if (model.has_field) model.field = lying_field(draw, answer);
  if (draw.chance(0.1)) spoil_model(draw, model);
  return model;
}

}  // namespace forcebound::lab
