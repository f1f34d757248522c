#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "forcebound/server/dynamics/bodies/apparent_mass.hpp"
#include "forcebound/server/dynamics/bodies/body_world.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

using text::rounded;
using text::to_text;

int find_body(const mjModel& model, const std::string& wanted, const std::string& file) {
  const int found = mj_name2id(&model, mjOBJ_BODY, wanted.c_str());
  if (found > 0) return found;
  std::vector<std::string> names;
  for (int i = 1; i < model.nbody; ++i) {
    if (const char* name = mj_id2name(&model, mjOBJ_BODY, i)) names.emplace_back(name);
  }
  throw BodiesError(file + ": no body '" + wanted + "' to be the probe" + text::suggestion(wanted, names));
}

int find_ball(const mjModel& model, int number) {
  return mj_name2id(&model, mjOBJ_BODY, name_of_probe(number).c_str());
}

/// The point of the first body that a device meets on its way down to the body's middle.
scene::Point top_m(const mjModel& model, mjData& data, int ball) {
  double above_m = 0;
  for (int i = 0; i < model.ngeom; ++i) above_m = std::max(above_m, data.geom_xpos[3 * i + 2] + model.geom_rbound[i]);
  const scene::Point from_m(data.xpos[3], data.xpos[4], above_m + 1);
  const scene::Point down = -scene::Point::UnitZ();
  int met = -1;
  return from_m + down * mj_ray(&model, &data, from_m.data(), down.data(), nullptr, 1, ball, &met);
}

constexpr const char* kHowToBeStable =
    " after a small disturbance: it is unstable by itself; use a shorter timestep, softer springs and actuators, or "
    "for strong damping the integrator implicit";

int fastest_of(const mjModel& model, const mjData& data) {
  int fastest = -1;
  for (int i = 0; i < model.nv; ++i) {
    if (fastest < 0 || std::abs(data.qvel[i]) > std::abs(data.qvel[fastest])) fastest = i;
  }
  return fastest;
}

std::string joint_at(const mjModel& model, int velocity) {
  const int joint = model.dof_jntid[velocity];
  if (const char* name = mj_id2name(&model, mjOBJ_JOINT, joint)) return "joint '" + std::string(name) + "'";
  const char* body = mj_id2name(&model, mjOBJ_BODY, model.jnt_bodyid[joint]);
  return body != nullptr ? "a joint of body '" + std::string(body) + "'" : "joint " + std::to_string(joint);
}

ModelPointer compile(const BodiesDescription& description, int probes, const std::string& name) {
  ModelPointer model = compile_mjcf(to_mjcf(description, probes), name);
  set_solver(*model, description.solver);
  return model;
}

std::string solver_text(const mjModel& model) {
  const SolverOptions solver = solver_of(model);
  return "contact forces by " + std::string(name_of(*solver.kind)) + ", iterations at most " +
         std::to_string(*solver.iterations) + ", tolerance " + to_text(*solver.tolerance);
}

std::size_t bytes_of(const mjModel& model) { return static_cast<std::size_t>(mj_sizeModel(&model)); }

}  // namespace

BodyDynamicModel::BodyDynamicModel(BodiesDescription description, std::string name)
    : description_(std::move(description)),
      name_(std::move(name)),
      coupling_(description_.coupling),
      model_(compile(description_, 1, name_)),
      apparent_mass_kg_(description_.probe.mass_kg) {
  check_coupling();
  const DataPointer data = make_data(*model_);
  const int ball = find_ball(*model_, 0);
  check_overlap(*data, ball);
  on_surface_m_ = top_m(*model_, *data, ball);
}

BodyDynamicModel::BodyDynamicModel(ModelPointer model, const std::vector<std::string>& probes, const Coupling& coupling,
                                   std::string name, const SolverOptions& solver)
    : name_(std::move(name)), coupling_(coupling), model_(std::move(model)) {
  set_solver(*model_, solver);
  const DataPointer data = make_data(*model_);
  for (const std::string& probe : probes) {
    dragged_.push_back(find_body(*model_, probe, name_));
    if (std::isinf(apparent_mass_kg(*model_, *data, {dragged_.back()}))) {
      throw BodiesError(name_ + ": body '" + probe +
                        "' must have a joint that moves its centre of mass to be the probe");
    }
  }
  apparent_mass_kg_ = apparent_mass_kg(*model_, *data, dragged_);
  check_coupling();
  on_surface_m_ = Eigen::Map<const scene::Point>(data->xipos + 3 * dragged_.front());
  check_motion();
}

void BodyDynamicModel::check_overlap(const mjData_& data, int ball) const {
  constexpr double kAllowed_m = 1e-4;
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    const int first = model_->geom_bodyid[contact.geom1];
    const int second = model_->geom_bodyid[contact.geom2];
    if (contact.dist > -kAllowed_m || first == ball || second == ball) continue;
    // Body 0 is the world.
    const auto name = [&](int body) { return description_.bodies[static_cast<std::size_t>(body - 1)].name; };
    throw BodiesError(name_ + ": '" + name(first) + "' and '" + name(second) + "' begin " + rounded(-contact.dist) +
                      " m within each other: expected at most " + to_text(kAllowed_m));
  }
}

double BodyDynamicModel::share_of_stable() const noexcept {
  return coupling_.share_of_stable(apparent_mass_kg_, model_->opt.timestep);
}

void BodyDynamicModel::check_coupling() const {
  if (share_of_stable() < 1) return;
  throw BodiesError(name_ + ": the probe's coupling of " + to_text(coupling_.stiffness_N_per_m) + " N/m and " +
                    to_text(coupling_.damping_N_s_per_m) + " N s/m is unstable with an apparent mass of " +
                    rounded(apparent_mass_kg_) + " kg in steps of " + to_text(model_->opt.timestep) + " s (" +
                    rounded(share_of_stable()) +
                    " of what is stable): use a softer one, a heavier probe or shorter steps");
}

void BodyDynamicModel::check_motion() const {
  constexpr int kSteps = 500;
  constexpr double kNudge_m_per_s = 1e-3;  // or rad/s
  constexpr double kAside_m = 1e-3;
  // Metres or radians: an amplitude of 1.5 at the limit of stability stays below that.
  constexpr double kPerStep_max = 3;
  const double step_s = model_->opt.timestep;
  const std::unique_ptr<BodyWorld> world = make_world();
  for (const int body : dragged_) {
    const scene::Point begin_m = Eigen::Map<const scene::Point>(world->data().xipos + 3 * body);
    world->move(world->join(), begin_m + scene::Point::Constant(kAside_m), scene::Point::Zero());
  }
  // Excites every mode.
  for (int i = 0; i < model_->nv; ++i) world->data().qvel[i] += kNudge_m_per_s * std::cos(i);
  for (int i = 1; i <= kSteps; ++i) {
    world->advance(step_s);
    const auto after = [&] { return " after " + std::to_string(i) + " steps of " + to_text(step_s) + " s"; };
    if (!world->sound()) throw BodiesError(name_ + ": MuJoCo fails" + after() + kHowToBeStable);
    const int fastest = fastest_of(*model_, world->data());
    // Free fall is allowed.
    const double fallen_m_per_s = i * step_s * mju_norm3(model_->opt.gravity);
    const double speed = fastest < 0 ? 0 : std::abs(world->data().qvel[fastest]);
    if (step_s * (speed - fallen_m_per_s) <= kPerStep_max) continue;
    throw BodiesError(name_ + ": " + joint_at(*model_, fastest) + " is at " + rounded(speed) + " m/s or rad/s" +
                      after() + kHowToBeStable);
  }
}

std::unique_ptr<BodyWorld> BodyDynamicModel::make_world() const {
  std::vector<BodyWorld::Probe> probes;
  for (const int body : dragged_) probes.push_back({.body = body});
  return std::make_unique<BodyWorld>(copy_of(*model_), coupling_, probes);
}

std::unique_ptr<scene::DynamicModelState> BodyDynamicModel::make_state(int seats) const {
  if (!dragged_.empty()) return make_world();
  std::vector<BodyWorld::Probe> probes;
  ModelPointer model = seats == 1 ? copy_of(*model_) : compile(description_, seats, name_);
  for (int i = 0; i < seats; ++i) {
    const int body = find_ball(*model, i);
    probes.push_back({.body = body,
                      .slides = model->jnt_qposadr[model->body_jntadr[body]],
                      .weld = mj_name2id(model.get(), mjOBJ_EQUALITY, name_of_grasp(i).c_str())});
  }
  return std::make_unique<BodyWorld>(std::move(model), coupling_, probes, description_.grasp);
}

scene::DynamicModelFacts BodyDynamicModel::facts() const {
  const double step_s = model_->opt.timestep;
  const double steps_per_motion = std::max(1.0, 1e-3 / step_s);
  scene::DynamicModelFacts facts{
      .memory_bytes = bytes_of(*model_),
      .state_bytes = bytes_of(*model_) + static_cast<std::size_t>(model_->nstack) * sizeof(mjtNum),
      .stiffness_N_per_m = coupling_.stiffness_N_per_m,
      .damping_N_s_per_m = coupling_.damping_N_s_per_m,
      .age_s = step_s,
      .cost_ns = steps_per_motion * (2000.0 + 1500.0 * model_->nv),
      .describe_cost_ns = DraggedBodies::predicted_cost_ns(*model_),
      .on_surface_m = on_surface_m_,
      .describes_itself = BodyMobility::can_do(*model_),
      .inputs = {.velocity = true, .time = true}};
  facts.lines = {std::to_string(model_->nbody - 1) + " bodies, " + std::to_string(model_->nv) +
                     " degrees of freedom, by MuJoCo in steps of " + to_text(step_s) + " s",
                 solver_text(*model_),
                 "coupling " + to_text(coupling_.stiffness_N_per_m) + " N/m, " + to_text(coupling_.damping_N_s_per_m) +
                     " N s/m to an apparent mass of " + rounded(apparent_mass_kg_) + " kg at the start: at " +
                     rounded(100 * share_of_stable()) + " % of what is stable"};
  if (description_.grasp) {
    facts.lines.push_back("while button " + std::to_string(description_.grasp->button) +
                          " is pressed, a device holds the body that it touches, up to " +
                          to_text(description_.grasp->force_N_max) + " N");
  }
  if (!dragged_.empty()) facts.seats_max = static_cast<int>(dragged_.size());
  return facts;
}

}  // namespace forcebound::server
