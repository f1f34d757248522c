#include "forcebound/scene/effects/bristle.hpp"

namespace forcebound::scene {
namespace {

using BristleNumbers = Eigen::Map<Point>;

Point in_plane(const Point& vector, const Point& normal) noexcept { return vector - normal.dot(vector) * normal; }

}  // namespace

Point Bristle::move(const Law& law, const Limits& limits, const Step& step) noexcept {
  BristleNumbers deflection(deflection_m);
  BristleNumbers last(position_m);
  const Point moved = touched > 0 ? in_plane(step.position_m - last, step.normal) : Point(Point::Zero());
  const Point before = in_plane(deflection, step.normal);
  last = step.position_m;
  touched = 1;

  const double drag_N_per_m = step.interval_s > 0 ? law.damping_N_s_per_m / step.interval_s : 0;
  const Point wanted_N = law.stiffness_N_per_m * (before + moved) + drag_N_per_m * moved;
  const double wanted_length_N = wanted_N.norm();
  slipping = wanted_length_N > (slipping > 0 ? limits.slipping_N : limits.sticking_N) ? 1 : 0;
  if (slipping == 0) {
    deflection = before + moved;
    return wanted_N;
  }
  const Point force_N = wanted_N * (limits.slipping_N / wanted_length_N);
  deflection = (force_N + drag_N_per_m * before) / (law.stiffness_N_per_m + drag_N_per_m);
  return force_N;
}

}  // namespace forcebound::scene
