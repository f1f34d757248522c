#pragma once

#include <chrono>

#include "forcebound/local_model/local_model.hpp"

namespace forcebound::test {

/// A pad whose surface lies at z = 0, pressed 2 mm deep at 2 N; it gives way a bit more with time. All of its numbers
/// have at most 24 bits.
inline local_model::Surface pad() {
  return {.id = 7,
          .force_N = {0, 0, 2},
          .place_m = {0.125, -0.25, 0},
          .normal = {0, 0, 1},
          .stiffness_N_per_m = Eigen::Vector3d(0, 0, 1000).asDiagonal(),
          .damping_N_s_per_m = 0.5,
          .velocity_m_per_s = {0, 0, 0.25},
          .acceleration_m_per_s2 = {0, 0.5, 1},
          .relaxing_N_per_m = 200,
          .relaxation_s = 0.125,
          .relaxed_N = 0.25,
          .friction = 0.375,
          .radius_m = 0.015625,
          .others_move_it = true};
}

/// A puck of 125 g that pushes a button of 250 g along x, 62.5 mm before a wall, and lies on a table.
inline local_model::Mass puck() {
  local_model::Mass mass{.id = 9,
                         .force_N = {-0.5, 0, 0},
                         .place_m = {0.25, 0.5, 0},
                         .stiffness_N_per_m = 500,
                         .damping_N_s_per_m = 4,
                         .body = {.velocity_m_per_s = {0.125, 0, 0},
                                  .bias_m_per_s2 = {-1, 0, 0.5},
                                  .mobility_per_kg = Eigen::Vector3d(8, 8, 8).asDiagonal(),
                                  .spring_N_per_m = 16,
                                  .damper_N_s_per_m = 0.5,
                                  .dry_friction_N = 0.25},
                         .contact_count = 2,
                         .radius_m = 0.25,
                         .others_move_it = true};
  mass.contacts[0] = {.normal = {-1, 0, 0},
                      .gap_m = -0.0009765625,
                      .compliance_per_kg = 0.75,
                      .stiffness_per_s2 = 60000,
                      .damping_per_s = 512,
                      .friction = 0.5,
                      .radius_m = 0.03125,
                      .travel_m = 0.0625,
                      .return_m = 0.5,
                      .met = {.velocity_m_per_s = {0.125, 0, 0.5},
                              .bias_m_per_s2 = {0.5, 0, -1},
                              .mobility_per_kg = Eigen::Vector3d(4, 2, 1).asDiagonal(),
                              .spring_N_per_m = 400,
                              .damper_N_s_per_m = 2,
                              .dry_friction_N = 0.125}};
  mass.contacts[1] = {.normal = {0, 0, 1}, .gap_m = 0.5, .compliance_per_kg = 1, .stiffness_per_s2 = 1000};
  return mass;
}

inline local_model::Field eddy() {
  local_model::Field field{
      .force_N = {0, 0.5, 0}, .place_m = {0.125, -0.25, 0.5}, .jacobian_N_per_m = {}, .radius_m = 0.0625};
  field.jacobian_N_per_m << 0, 10, 0, -10, 0, 0, 0, 0, -50;
  return field;
}

/// One of each.
inline local_model::LocalModel sample_local_model() {
  local_model::LocalModel model{.by_device_clock = true, .before_reading = std::chrono::microseconds{-1500}};
  model.surfaces[0] = pad();
  model.surface_count = 1;
  model.mass = puck();
  model.has_mass = true;
  model.field = eddy();
  model.has_field = true;
  return model;
}

}  // namespace forcebound::test
