#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/tools/lab/accuracy/device_error.hpp"
#include "tests/tools/lab/accuracy/harmonic_hand.hpp"
#include "tests/tools/lab/accuracy/reference_model.hpp"
#include "tests/tools/lab/accuracy/session_settings.hpp"
#include "tests/tools/lab/accuracy/sweep.hpp"

namespace forcebound::lab {

/// A study of accuracy against time: one key of a scene or a session, its values, and networks from near to far.
struct Study {
  std::string scene_text;
  std::string scene_file;  ///< files in the scene lie beside it
  Sweep sweep;             ///< of a scene's key from coarse to fine or back, unless something else is exact
  std::vector<server::SceneChange> fixed{};  ///< changes of the scene for all runs
  std::vector<double> round_trips_s{};
  HarmonicMotion motion{};
  std::string hand{};  ///< the specification of an operator, such as "replay:FILE.csv", in place of `motion`
  std::string device = "cartesian-3dof";
  SessionSettings session{};
  double duration_s = 2;
  std::shared_ptr<const scene::Scene> reference{};  ///< null: the levels' limit, or a tight solver of bodies
};

/// One value of the key.
struct StudiedSetting {
  std::string value;
  StepCost cost{};
  StepCost idle{};  ///< of a loop of equal length, measured at the same time
  StepWork per_step{};
  StateError at_states{};
  double velocity_at_states = 0;       ///< error of the velocity changes by contacts, where there are bodies
  double free_force = 0;               ///< error of the force running freely along the same path
  std::optional<BodyRecord> bodies{};  ///< of that run
  std::string trouble{};               ///< not empty: failed or not converged, a cross in the figure
  struct Behind {
    double round_trip_s = 0;
    DeviceError error{};
    double passivity_minimum_J = 0;
    double turns_missed = 0;
  };
  std::vector<Behind> behind{};  ///< one for each round trip

  /// Whether the device never returned more energy than its damping dissipated, but for rounding.
  [[nodiscard]] bool stays_passive(std::size_t round_trip) const {
    return behind[round_trip].passivity_minimum_J >= -kRounding_J;
  }
  static constexpr double kRounding_J = 1e-6;
};

struct StudyResult {
  std::string key;
  std::string hand;
  std::string assumptions{};  ///< which hand, device and place the figures hold for: lines
  std::string fixed{};
  std::string session{};         ///< before the sweep changed it
  double server_step_us = 1000;  ///< the server's time for a motion at the session's rate
  bool same_scene = false;       ///< the key is of the session: the scene's results are the same for all
  double change_per_s = 0;       ///< RMS of the reference's rate of change over its own, along the hand's way
  /// By how much the error of what the client extrapolates grows with its age, from the runs behind the networks; 0:
  /// all was held, or it does not grow.
  double extrapolation_per_s = 0;
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

/// The study's scene with what is fixed and further changes, which errors name.
/// @throws server::SceneError
std::shared_ptr<const scene::Scene> compile(const Study& study, const std::vector<server::SceneChange>& further = {});

/// A key of a scene has a dot; another one is of the session (`session_keys`). With a key of the session there is one
/// scene, which is its own reference unless there is another, and all settings are compared with it.
/// @param progress called with the share done; may be empty
/// @throws what the scene's variants, hand, device and law refuse
StudyResult carry_out(Study study, const time::Clock& clock, const std::function<void(double done)>& progress = {});

/// The value with the least error at the device behind a round trip, of those within a budget. Not counted are settings
/// that failed, and settings of a session that were not passive: a law that bounds less has less error, but is not
/// passive. None: there is none.
std::optional<std::size_t> best_setting(const StudyResult& result, std::size_t round_trip, double budget_us);

}  // namespace forcebound::lab
