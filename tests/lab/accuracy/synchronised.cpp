#include "tests/lab/accuracy/synchronised.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "forcebound/server/bodies/body_world.hpp"

namespace forcebound::lab {
namespace {

using ScenePointer = std::shared_ptr<const server::Scene>;
using server::BodyWorld;

constexpr double kTick_s = 1e-3;

bool copy_media(server::SceneState& to, const server::SceneState& from) {
  const server::MediaNow source = from.media();
  const server::MediaNow target = to.media();
  if (source.empty() || source.size() != target.size()) return false;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (!target[i]->state().copy_from(source[i]->state())) return false;
  }
  return true;
}

/// Velocities of all bodies of a state, one vector for each medium that has some.
using Velocities = std::vector<Eigen::VectorXd>;

Velocities velocities_of(const server::SceneState& state) {
  Velocities velocities;
  const server::MediaNow media = state.media();
  for (std::size_t i = 0; i < media.size(); ++i) {
    const BodyWorld* const world = body_world(media, i);
    if (world == nullptr) continue;
    velocities.emplace_back(Eigen::Map<const Eigen::VectorXd>(world->data().qvel, world->model().nv));
  }
  return velocities;
}

/// Adds what the last tick would have changed without contacts.
void add_unhindered(Velocities& velocities, const server::SceneState& state) {
  const server::MediaNow media = state.media();
  std::size_t which = 0;
  for (std::size_t i = 0; i < media.size(); ++i) {
    const BodyWorld* const world = body_world(media, i);
    if (world == nullptr) continue;
    velocities[which++] += kTick_s * Eigen::Map<const Eigen::VectorXd>(world->data().qacc_smooth, world->model().nv);
  }
}

/// |a - b|^2 by the mass matrices of a state.
double squared_J(const server::SceneState& state, const Velocities& a, const Velocities& b) {
  double sum = 0;
  std::size_t which = 0;
  const server::MediaNow media = state.media();
  for (std::size_t i = 0; i < media.size(); ++i) {
    const BodyWorld* const world = body_world(media, i);
    if (world == nullptr) continue;
    const Eigen::VectorXd difference = a[which] - b[which];
    Eigen::VectorXd momentum(difference.size());
    mj_mulM(&world->model(), &world->data(), momentum.data(), difference.data());
    sum += momentum.dot(difference);
    ++which;
  }
  return sum;
}

/// Of all bodies of all scenes.
std::vector<double> steps_of(const std::vector<ScenePointer>& scenes) {
  std::vector<double> steps_s;
  for (const ScenePointer& scene : scenes) {
    for (const server::SceneMedium& medium : scene->media()) {
      if (const double step_s = medium.medium->facts().age_s; step_s > 0) steps_s.push_back(step_s);
    }
  }
  return steps_s;
}

}  // namespace

int ticks_in_common(const std::vector<double>& steps_s) {
  constexpr int kMost = 20;
  constexpr double kEven = 1e-6;
  const auto is_even = [](int ticks, double step_s) {
    const double steps = ticks * kTick_s / step_s;
    return steps > 2 - kEven && std::abs(steps - std::round(steps)) < kEven;
  };
  for (int ticks = 1; ticks <= kMost; ++ticks) {
    if (std::ranges::all_of(steps_s, [&](double step_s) { return is_even(ticks, step_s); })) return ticks;
  }
  return kMost;
}

std::optional<Synchronised> run_synchronised(const std::vector<ScenePointer>& settings, std::size_t reference,
                                             const std::vector<Vector>& positions_m) {
  const auto dof = static_cast<std::uint32_t>(positions_m.front().rows());
  std::vector<std::unique_ptr<server::SceneState>> states;
  for (const ScenePointer& scene : settings) states.push_back(std::make_unique<server::SceneState>(scene, dof));
  server::SceneState& saved = *states[reference];
  const auto put_there = [&](const auto& state) { return state.get() == &saved || copy_media(*state, saved); };
  if (!std::ranges::all_of(states, put_there)) return std::nullopt;
  Synchronised result{.ticks = ticks_in_common(steps_of(settings)),
                      .runs = std::vector<Along>(settings.size()),
                      .velocity_errors = std::vector<double>(settings.size())};
  double changed_J = 0;
  Velocities unhindered;
  for (std::size_t tick = 0; tick < positions_m.size(); ++tick) {
    const auto ticks = static_cast<std::size_t>(result.ticks);
    // On the first tick nothing steps: it says where the device is.
    if (tick > 0 && (tick - 1) % ticks == 0) {
      unhindered = velocities_of(saved);
      if (!std::ranges::all_of(states, put_there)) return std::nullopt;
    }
    std::vector<server::SceneAnswer> answers;
    for (const auto& state : states) {
      answers.push_back(state->answer(positions_m[tick], std::chrono::milliseconds(tick)));
    }
    if (tick == 0) continue;
    add_unhindered(unhindered, saved);
    if (tick % ticks != 0) continue;
    const Velocities after = velocities_of(saved);
    changed_J += squared_J(saved, after, unhindered);
    for (std::size_t i = 0; i < states.size(); ++i) {
      result.velocity_errors[i] += squared_J(saved, velocities_of(*states[i]), after);
      result.runs[i].forces.push_back(answers[i].force);
      result.runs[i].penetrations_m.push_back(answers[i].penetration_m);
    }
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    result.velocity_errors[i] = changed_J > 0 ? std::sqrt(result.velocity_errors[i] / changed_J) : 0;
    result.runs[i].trouble = trouble_of(states[i]->faults(), positions_m.size());
  }
  return result;
}

}  // namespace forcebound::lab
