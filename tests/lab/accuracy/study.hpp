#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/lab/accuracy/device_error.hpp"
#include "tests/lab/accuracy/harmonic_hand.hpp"
#include "tests/lab/accuracy/reference_model.hpp"
#include "tests/lab/accuracy/scene_variant.hpp"

namespace forcebound::lab {

/// What accuracy costs in time: one key of a scene, its values from coarse to fine, and networks from near to far.
struct Study {
  std::string scene_text;
  std::string scene_file;  ///< files in the scene lie beside it
  Sweep sweep;
  std::string fixed{};  ///< what of the scene was changed before, for people
  std::vector<double> round_trips_s{};
  HarmonicMotion motion{};
  std::string device = "cartesian-3dof";
  std::string law = "fba-exact";
  double duration_s = 2;
  double server_turn_least_s = 0;                    ///< a server that is asked to answer less often
  std::shared_ptr<const server::Scene> reference{};  ///< null: what the levels tend to, or a tight solver of bodies
};

/// One value of the key.
struct StudiedSetting {
  std::string value;
  StepCost cost{};
  StepCost idle{};  ///< of a loop that takes as long, in the same minute
  StepWork per_step{};
  StateError at_states{};
  double velocity_at_states = 0;       ///< error of what contacts change of velocities, where there are bodies
  double free_force = 0;               ///< error of the force where it runs freely along the same way
  std::optional<BodyRecord> bodies{};  ///< then
  std::string trouble{};               ///< not empty: failed or not converged, a cross in the figure
  struct Behind {
    double round_trip_s = 0;
    DeviceError error{};
    double passivity_minimum_J = 0;
    double turns_missed = 0;
  };
  std::vector<Behind> behind{};  ///< one for each round trip
};

struct StudyResult {
  std::string key;
  std::string hand;
  std::string fixed{};
  double change_per_s = 0;           ///< RMS of the reference's rate of change over its own, along the hand's way
  double reference_uncertainty = 0;  ///< at the same states
  double velocity_uncertainty = 0;   ///< at the same states, of what contacts change of velocities
  double free_uncertainty = 0;       ///< running freely along the same way, or behind a network
  double reference_order = 0;
  std::string reference_why{};
  int ticks_between_states = 0;  ///< 0: no state was saved, all went along the same positions
  std::optional<BodyRecord> reference_bodies{};
  std::string reference_trouble{};  ///< what is wrong with the reference's own run
  bool places_known = true;         ///< whether the reference knows where bodies come to rest
  std::size_t answer_bytes = 0;     ///< of one answer to a client, as a datagram
  std::vector<StudiedSetting> settings{};
};

/// @throws what the scene's variants, device and law refuse
StudyResult carry_out(Study study, const time::Clock& clock);

/// The value with the least error at the device behind a round trip, of those within a budget; crosses do not count.
/// None: there is none.
std::optional<std::size_t> best_setting(const StudyResult& result, std::size_t round_trip, double budget_us);

/// A sweep that shows what the scene has to offer: the levels it may be picked from, a tissue's cells, a distance
/// field's cell, the bodies' time step.
/// @throws std::invalid_argument if there is nothing of the kind
Sweep usual_sweep(const std::string& scene_text);

/// The scene itself with what finds its bodies' forces at its best, twice by different ways: Newton's method and
/// conjugate gradients, as far as they go. Nothing for a key that is not about that.
struct TightSolvers {
  std::string newton;  ///< text of a scene
  std::string cg;
};
std::optional<TightSolvers> tight_solvers(const std::string& scene_text, const std::string& key);

/// How coarse a value is, in any unit: of a list the inverse of its first number, of a number whose key ends in _m or
/// _s itself, of another number its inverse. Nothing for what is no number.
std::optional<double> spacing_of(const std::string& key, const std::string& value);

}  // namespace forcebound::lab
