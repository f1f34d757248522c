#include "tests/tools/lab/accuracy/synchronised.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "forcebound/server/dynamics/bodies/body_world.hpp"

namespace forcebound::lab {
namespace {

using ScenePointer = std::shared_ptr<const scene::Scene>;
using server::BodyWorld;

constexpr double kTick_s = 1e-3;

bool copy_dynamic_models(scene::SceneState& to, const scene::SceneState& from) {
  const scene::DynamicModelsNow source = from.dynamic_models();
  const scene::DynamicModelsNow target = to.dynamic_models();
  if (source.empty() || source.size() != target.size()) return false;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (!target[i]->state().copy_from(source[i]->state())) return false;
  }
  return true;
}

/// Velocities of all bodies of a state, one vector for each dynamic model that has some.
using Velocities = std::vector<Eigen::VectorXd>;

Velocities velocities_of(const scene::SceneState& state) {
  Velocities velocities;
  const scene::DynamicModelsNow dynamic_models = state.dynamic_models();
  for (std::size_t i = 0; i < dynamic_models.size(); ++i) {
    const BodyWorld* const world = body_world(dynamic_models, i);
    if (world == nullptr) continue;
    velocities.emplace_back(Eigen::Map<const Eigen::VectorXd>(world->data().qvel, world->model().nv));
  }
  return velocities;
}

/// Adds what the last tick would have changed without contacts.
void add_unhindered(Velocities& velocities, const scene::SceneState& state) {
  const scene::DynamicModelsNow dynamic_models = state.dynamic_models();
  std::size_t which = 0;
  for (std::size_t i = 0; i < dynamic_models.size(); ++i) {
    const BodyWorld* const world = body_world(dynamic_models, i);
    if (world == nullptr) continue;
    velocities[which++] += kTick_s * Eigen::Map<const Eigen::VectorXd>(world->data().qacc_smooth, world->model().nv);
  }
}

/// |a - b|^2 by the mass matrices of a state.
double squared_J(const scene::SceneState& state, const Velocities& a, const Velocities& b) {
  double sum = 0;
  std::size_t which = 0;
  const scene::DynamicModelsNow dynamic_models = state.dynamic_models();
  for (std::size_t i = 0; i < dynamic_models.size(); ++i) {
    const BodyWorld* const world = body_world(dynamic_models, i);
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
    for (const scene::SceneDynamicModel& dynamic_model : scene->dynamic_models()) {
      if (const double step_s = dynamic_model.dynamic_model->facts().age_s; step_s > 0) steps_s.push_back(step_s);
    }
  }
  return steps_s;
}

/// All settings, on the path of the reference.
class Company {
 public:
  Company(const std::vector<ScenePointer>& settings, std::size_t reference, std::uint32_t degrees_of_freedom)
      : reference_(reference), answers_(settings.size()) {
    found_.runs.resize(settings.size());
    found_.velocity_errors.resize(settings.size());
    states_.reserve(settings.size());
    for (const ScenePointer& scene : settings) {
      states_.push_back(std::make_unique<scene::SceneState>(scene, degrees_of_freedom));
    }
  }

  /// Copies the reference's state to all; false if that is not possible.
  [[nodiscard]] bool gather() {
    unhindered_ = velocities_of(reference());
    return std::ranges::all_of(states_, [&](const auto& state) {
      return state.get() == &reference() || copy_dynamic_models(*state, reference());
    });
  }

  void go(const Vector& position_m, time::Nanoseconds now) {
    for (std::size_t i = 0; i < states_.size(); ++i) answers_[i] = states_[i]->answer(position_m, now);
    add_unhindered(unhindered_, reference());
  }

  void compare() {
    const Velocities right = velocities_of(reference());
    changed_J_ += squared_J(reference(), right, unhindered_);
    for (std::size_t i = 0; i < states_.size(); ++i) {
      found_.velocity_errors[i] += squared_J(reference(), velocities_of(*states_[i]), right);
      found_.runs[i].forces.push_back(answers_[i].force);
      found_.runs[i].penetrations_m.push_back(answers_[i].penetration_m);
    }
  }

  [[nodiscard]] Synchronised result(int ticks, std::size_t steps) const {
    Synchronised result = found_;
    result.ticks = ticks;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      double& error = result.velocity_errors[i];
      error = changed_J_ > 0 ? std::sqrt(error / changed_J_) : 0;
      result.runs[i].trouble = trouble_of(states_[i]->faults(), steps);
    }
    return result;
  }

 private:
  [[nodiscard]] const scene::SceneState& reference() const { return *states_[reference_]; }

  std::size_t reference_;
  std::vector<std::unique_ptr<scene::SceneState>> states_;
  std::vector<scene::Answer> answers_;
  Velocities unhindered_{};  ///< velocities without contacts since the last copy
  double changed_J_ = 0;
  Synchronised found_{};
};

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
  Company company(settings, reference, static_cast<std::uint32_t>(positions_m.front().rows()));
  if (!company.gather()) return std::nullopt;
  const int ticks = ticks_in_common(steps_of(settings));
  for (std::size_t tick = 0; tick < positions_m.size(); ++tick) {
    // On the first tick nothing steps: it only sets the device's position.
    const auto done = static_cast<int>(tick % static_cast<std::size_t>(ticks));
    if (tick > 0 && (done == 1 || ticks == 1) && !company.gather()) return std::nullopt;
    company.go(positions_m[tick], std::chrono::milliseconds(tick));
    if (tick > 0 && done == 0) company.compare();
  }
  return company.result(ticks, positions_m.size());
}

}  // namespace forcebound::lab
