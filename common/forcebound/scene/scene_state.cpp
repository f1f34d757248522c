#include "forcebound/scene/scene_state.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "forcebound/control/rotation.hpp"
#include "forcebound/scene/tool/tool_touch.hpp"

namespace forcebound::scene {
namespace {

/// Of an object whose geometry has just arrived the shape's may be another.
bool have_states_of_the_same_effects(const PlanStep& a, const PlanStep& b) noexcept {
  return a.end - a.begin == b.end - b.begin && a.touching_state - a.near_state == b.touching_state - b.near_state &&
         a.end_state - a.near_state == b.end_state - b.near_state;
}

/// Of the points and edge contacts of the tool.
std::size_t states_of(const Scene& scene) noexcept {
  return scene.facts().tool ? ToolTouch::states_of(*scene.facts().tool) : 1;
}

/// Of one of them.
void copy_states(std::span<const PlanStep> before, const std::byte* from, std::span<const PlanStep> steps,
                 std::byte* to) noexcept {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const PlanStep& old = before[i];
    const PlanStep& step = steps[i];
    if (old.near_state - old.shape_state == step.near_state - step.shape_state) {
      std::copy(from + old.shape_state, from + old.near_state, to + step.shape_state);
    } else {
      std::fill(to + step.shape_state, to + step.near_state, std::byte{0});
    }
    std::copy(from + old.near_state, from + old.end_state, to + step.near_state);
  }
}

}  // namespace

SceneState::SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom,
                       const DynamicModelsNow& dynamic_models, bool shares_dynamic_models)
    : scene_(std::move(scene)),
      rows_(degrees_of_freedom),
      translations_(std::min<Eigen::Index>(rows_, 3)),
      bytes_(scene_->plan().state_bytes() * states_of(*scene_)),
      steps_(scene_->plan().steps().size()),
      shares_dynamic_models_(shares_dynamic_models) {
  if (scene_->facts().tool) tool_ = std::make_unique<ToolTouch>(scene_->facts().tool, *scene_);
  std::iota(steps_.begin(), steps_.end(), 0U);
  couplings_.reserve(dynamic_models.size());
  for (const auto& dynamic_model : dynamic_models) couplings_.emplace_back(dynamic_model);
  dynamic_models_.resize(couplings_.size());
  std::iota(dynamic_models_.begin(), dynamic_models_.end(), 0U);
  quarantined_.reserve(steps_.size() + couplings_.size());
}

SceneState::SceneState(const std::shared_ptr<const Scene>& scene, std::uint32_t degrees_of_freedom)
    : SceneState(scene, degrees_of_freedom, begin_dynamic_models(*scene, 1), false) {}

SceneState::SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom,
                       const DynamicModelsNow& shared)
    : SceneState(std::move(scene), degrees_of_freedom, shared, true) {}

SceneState::SceneState(SceneState&&) noexcept = default;
SceneState& SceneState::operator=(SceneState&&) noexcept = default;
SceneState::~SceneState() = default;

SceneState SceneState::of_part(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom, std::size_t part) {
  const std::size_t steps = scene->plan().steps().size();
  DynamicModelsNow dynamic_models;
  if (part >= steps)
    dynamic_models.push_back(std::make_shared<DynamicModelNow>(scene->dynamic_models()[part - steps], 1));
  SceneState state(std::move(scene), degrees_of_freedom, dynamic_models, false);
  state.steps_.clear();
  if (part < steps) state.steps_.push_back(static_cast<std::uint32_t>(part));
  return state;
}

Answer SceneState::answer(const Vector& position, Nanoseconds device_time, Nanoseconds server_time, bool wants_model,
                          const Handle& handle) noexcept {
  Probe probe;
  probe.position_m = place(position);
  probe.handle = handle;
  if (scene_->inputs().velocity || scene_->inputs().time) look_at_time(probe, device_time);
  if (tool_ && handle.orientation)
    tool_->move(
        {.tip_m = probe.position_m, .rotation = control::quaternion_of(*handle.orientation).toRotationMatrix()});

  Answer answer;
  answer.model.by_device_clock = wants_model && !shares_dynamic_models_;
  quarantined_.clear();
  contacts_ = 0;
  if (tool_ && handle.orientation) tool_->meet(scene_->plan(), steps_, bytes_);
  Totals totals;
  feel_steps(probe, totals, answer);
  FeltAt felt_at{.moment = shares_dynamic_models_ ? server_time : device_time};
  // A client that is told no local model has the force as soon as it can be.
  if (shares_dynamic_models_ && wants_model) felt_at.reading = device_time;
  feel_dynamic_models(probe, felt_at, device_time, wants_model, totals, answer);
  answer.force = in_device_rows(totals.force_N);
  if (tool_) answer.torque_N_m = totals.torque_N_m;
  const Vector server_parts = in_device_rows(totals.server_parts_N);
  if (!server_parts.isZero(0)) answer.server_parts_N = server_parts;
  if (scene_->plan().fades_without_server()) answer.fading_N = in_device_rows(totals.fading_N);
  return answer;
}

void SceneState::feel_steps(Probe probe, Totals& totals, Answer& answer) noexcept {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ToolFelt felt = feel_step(steps_[i], probe);
    const Reaction& reaction = felt.reaction;
    const double deepest_m = answer.penetration_m;
    if (felt.torque_N_m.allFinite() && add(reaction, felt.deepest, totals.force_N, answer)) {
      const bool in_server_parts = scene_->rendering_of_part(steps_[i]).how != Rendering::at_client;
      if (in_server_parts) totals.server_parts_N += reaction.force_N;
      totals.fading_N += reaction.fading_N;
      totals.torque_N_m += felt.torque_N_m;
      contacts_ += felt.contacts;
      if (answer.penetration_m > deepest_m)
        answer.texture_in_server_parts = in_server_parts && reaction.texture.amplitude_N > 0;
      continue;
    }
    quarantine(scene_->name_of_step(steps_[i]));
    steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(i--));
  }
}

ToolFelt SceneState::feel_step(std::uint32_t number, Probe& probe) noexcept {
  const Plan& plan = scene_->plan();
  const PlanStep& step = plan.steps()[number];
  if (tool_ && step.shape != nullptr)
    return probe.handle.orientation ? tool_->feel(plan, number, probe, bytes_) : ToolFelt{};
  const PlanRun at_tip(plan, bytes_.data());
  ToolFelt felt{.deepest = at_tip.find_surface(step, probe.position_m)};
  probe.normal = felt.deepest.normal;
  probe.penetration_m = felt.deepest.penetration_m;
  at_tip.act(step, probe, felt.reaction);
  felt.contacts = felt.deepest.penetration_m > 0 ? 1 : 0;
  return felt;
}

void SceneState::feel_dynamic_models(const Probe& probe, const FeltAt& felt_at, Nanoseconds device_time,
                                     bool wants_model, Totals& totals, Answer& answer) noexcept {
  for (std::size_t i = 0; i < dynamic_models_.size(); ++i) {
    DynamicModelCoupling& coupling = couplings_[dynamic_models_[i]];
    const ModelTouch touch = coupling.feel(probe, felt_at, faults_.dynamic_models);
    const SurfacePoint surface{.normal = touch.normal, .penetration_m = touch.penetration_m};
    if (coupling.sound() && add({.force_N = touch.force_N}, surface, totals.force_N, answer)) {
      const std::size_t part = scene_->plan().steps().size() + dynamic_models_[i];
      if (scene_->rendering_of_part(part).how == Rendering::at_client) continue;
      totals.server_parts_N += touch.force_N;
      if (wants_model) {
        describe(coupling, dynamic_models_[i], answer.model);
        if (const auto before = coupling.played_before(device_time)) {
          answer.model.by_device_clock = true;
          answer.model.before_reading = *before;
        }
      }
      continue;
    }
    quarantine(coupling.name());
    dynamic_models_.erase(dynamic_models_.begin() + static_cast<std::ptrdiff_t>(i--));
  }
}

/// What has no room in the answer is held.
void SceneState::describe(DynamicModelCoupling& coupling, std::uint32_t number,
                          local_model::LocalModel& model) noexcept {
  constexpr std::uint32_t kIdsOfAPart = 16;
  local_model::LocalModel part;
  if (!coupling.describe(part)) return;
  const std::uint32_t surfaces = std::min(part.surface_count, local_model::LocalModel::kSurfacesMax);
  for (std::uint32_t i = 0; i < surfaces; ++i) {
    part.surfaces.at(i).id += kIdsOfAPart * number;
    part.surfaces.at(i).others_move_it = shares_dynamic_models_;
  }
  part.mass.id += kIdsOfAPart * number;
  part.mass.others_move_it = shares_dynamic_models_;
  (void)local_model::add(part, model);
}

Point SceneState::place(const Vector& position) const noexcept {
  Point point = Point::Zero();
  point.head(translations_) = position.head(translations_);
  return point;
}

void SceneState::begin_again(const Vector& outside_m, Nanoseconds first_time) noexcept {
  std::ranges::fill(bytes_, std::byte{0});
  has_last_ = false;
  has_first_ = true;
  first_time_ = first_time;
  const Point free_m = place(outside_m);
  if (tool_) return tool_->begin_again(free_m);
  for (const PlanStep& step : scene_->plan().steps()) {
    if (step.shape != nullptr) step.shape->begin_outside(free_m, bytes_.data() + step.shape_state);
  }
}

bool SceneState::go_on_from(const SceneState& other) noexcept {
  const std::span<const PlanStep> steps = scene_->plan().steps();
  const std::span<const PlanStep> before = other.scene_->plan().steps();
  const bool same = other.rows_ == rows_ && other.couplings_.empty() && couplings_.empty() &&
                    std::ranges::equal(steps, before, have_states_of_the_same_effects);
  if (!same || (tool_ == nullptr) != (other.tool_ == nullptr)) return false;
  if (tool_ && !tool_->go_on_from(*other.tool_)) return false;
  for (std::size_t state = 0; state < states_of(*scene_); ++state) {
    const std::byte* const from = other.bytes_.data() + state * other.scene_->plan().state_bytes();
    copy_states(before, from, steps, bytes_.data() + state * scene_->plan().state_bytes());
  }
  // No larger than what was here at first, so nothing is allocated.
  steps_ = other.steps_;
  last_position_m_ = other.last_position_m_;
  first_time_ = other.first_time_;
  last_time_ = other.last_time_;
  has_first_ = other.has_first_;
  has_last_ = other.has_last_;
  faults_ = other.faults_;
  return true;
}

bool SceneState::add(const Reaction& reaction, const SurfacePoint& surface, Point& total_N, Answer& answer) noexcept {
  if (!surface.normal.allFinite() || !(total_N + reaction.force_N).allFinite()) return false;
  total_N += reaction.force_N;
  if (!(surface.penetration_m > 0)) return true;
  if (surface.normal_is_old) ++faults_.old_normals;
  if (surface.penetration_m > answer.penetration_m) {
    answer.penetration_m = surface.penetration_m;
    answer.contact_normal = in_device_rows(surface.normal);
    const Texture& texture = reaction.texture;
    const auto wave = [&](std::size_t i) {
      const bool any = texture.amplitude_N > 0 && static_cast<int>(i) < texture.waves;
      return any ? in_device_rows(texture.waves_rad_per_m.at(i)) : Vector();
    };
    answer.texture_N = texture.amplitude_N;
    answer.texture_wave = wave(0);
    answer.texture_across = wave(1);
  }
  return true;
}

void SceneState::quarantine(const std::string& name) noexcept {
  ++faults_.quarantined;
  quarantined_.push_back(&name);
}

const ToolPose* SceneState::simulated_tool() const noexcept { return tool_ ? tool_->simulated() : nullptr; }

DynamicModelsNow SceneState::dynamic_models() const {
  DynamicModelsNow dynamic_models;
  dynamic_models.reserve(couplings_.size());
  for (const DynamicModelCoupling& coupling : couplings_) dynamic_models.push_back(coupling.now());
  return dynamic_models;
}

std::size_t SceneState::sample(std::size_t dynamic_model, std::size_t first, std::span<float> to) const noexcept {
  if (dynamic_model >= couplings_.size() || !couplings_[dynamic_model].sound()) return 0;
  return couplings_[dynamic_model].now()->state().sample(first, to);
}

Vector SceneState::in_device_rows(const Point& point) const noexcept {
  Vector vector = Vector::Zero(rows_);
  vector.head(translations_) = point.head(translations_);
  return vector;
}

void SceneState::look_at_time(Probe& probe, Nanoseconds device_time) noexcept {
  if (!has_first_) first_time_ = device_time;
  has_first_ = true;
  probe.time_s = seconds_between(first_time_, device_time);
  if (has_last_) {
    probe.interval_s = seconds_between(last_time_, device_time);
    if (probe.interval_s > 0) {
      const Point velocity_m_per_s = (probe.position_m - last_position_m_) / probe.interval_s;
      // The difference of two finite positions may overflow.
      if (velocity_m_per_s.allFinite()) probe.velocity_m_per_s = velocity_m_per_s;
    }
  }
  has_last_ = true;
  last_time_ = device_time;
  last_position_m_ = probe.position_m;
}

}  // namespace forcebound::scene
