#pragma once

#include <vector>

/// Reference results for fba-exact's recursion by other methods: long double, no knots, no conjugates, minima by
/// search.
namespace forcebound::test {

/// A force held for a while.
struct ForcePiece {
  double force_N = 0;
  double duration_s = 0;
};

/// Damping and friction of one joint.
struct JointFacts {
  double damping_N_s_per_m = 0;
  double friction_N = 0;
};

/// The least energy that the joint dissipates beyond the forces' work, over all motions that cover `displacement_m` in
/// total while they are held one after the other [J].
long double least_cost_J(const JointFacts& joint, const std::vector<ForcePiece>& pieces, long double displacement_m);

/// One reading, and the forces in effect since the one before it.
struct ReferenceReading {
  double position_m = 0;
  std::vector<ForcePiece> since;
};

/// The least energy over all paths through tubes of width `step_m` about the readings [J], after the last one. By
/// coordinate descent, which finds the minimum of a smooth convex function in a box: only without friction.
long double least_energy_without_friction_J(const JointFacts& joint, double step_m,
                                            const std::vector<ReferenceReading>& readings);

/// The same for paths that pass the tubes at one of `points` places each: never below the true minimum, and close to
/// it.
long double least_energy_on_grid_J(const JointFacts& joint, double step_m,
                                   const std::vector<ReferenceReading>& readings, int points);

}  // namespace forcebound::test
