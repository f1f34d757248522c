#include "forcebound/server/bodies/body_medium.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "forcebound/server/bodies/body_world.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

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

std::size_t bytes_of(const mjModel& model) { return static_cast<std::size_t>(mj_sizeModel(&model)); }

}  // namespace

double Coupling::load(double mass_kg, double step_s) const noexcept {
  const double spring = step_s * step_s * stiffness_N_per_m / mass_kg;
  const double damper = step_s * damping_N_s_per_m / mass_kg;
  return std::max((spring + 2 * damper) / 4, damper / 2);
}

BodyMedium::BodyMedium(BodiesDescription description, std::string name)
    : description_(std::move(description)),
      name_(std::move(name)),
      coupling_{description_.probe.stiffness_N_per_m, description_.probe.damping_N_s_per_m},
      model_(compile_mjcf(to_mjcf(description_, 1), name_)) {
  check_coupling(description_.probe.mass_kg);
  check_overlap();
}

BodyMedium::BodyMedium(ModelPointer model, const std::vector<std::string>& probes, const Coupling& coupling,
                       std::string name)
    : name_(std::move(name)), coupling_(coupling), model_(std::move(model)) {
  for (const std::string& probe : probes) {
    const int body = find_body(*model_, probe, name_);
    const double mass_kg = model_->body_subtreemass[body];
    if (!(mass_kg > 0) || model_->body_weldid[body] == 0) {
      throw BodiesError(name_ + ": body '" + probe + "' must have a mass and a joint to be the probe");
    }
    check_coupling(mass_kg);
    probe_bodies_.push_back(body);
  }
}

void BodyMedium::check_overlap() const {
  constexpr double kAllowed_m = 1e-4;
  const DataPointer data = make_data(*model_);
  const int probe = mj_name2id(model_.get(), mjOBJ_BODY, "probe 0");
  for (int i = 0; i < data->ncon; ++i) {
    const mjContact& contact = data->contact[i];
    const int first = model_->geom_bodyid[contact.geom1];
    const int second = model_->geom_bodyid[contact.geom2];
    if (contact.dist > -kAllowed_m || first == probe || second == probe) continue;
    throw BodiesError(name_ + ": '" + mj_id2name(model_.get(), mjOBJ_BODY, first) + "' and '" +
                      mj_id2name(model_.get(), mjOBJ_BODY, second) + "' begin " + to_text(-contact.dist) +
                      " m within each other: expected at most " + to_text(kAllowed_m));
  }
}

void BodyMedium::check_coupling(double mass_kg) const {
  const double step_s = model_->opt.timestep;
  const double load = coupling_.load(mass_kg, step_s);
  if (load < 1) return;
  throw BodiesError(name_ + ": the probe's coupling of " + to_text(coupling_.stiffness_N_per_m) + " N/m and " +
                    to_text(coupling_.damping_N_s_per_m) + " N s/m is unstable with a mass of " + to_text(mass_kg) +
                    " kg in steps of " + to_text(step_s) + " s (" + to_text(load) +
                    " of what is stable): take a softer one, a heavier probe or shorter steps");
}

ModelPointer BodyMedium::copy_of_model() const { return ModelPointer(mj_copyModel(nullptr, model_.get())); }

std::unique_ptr<MediumState> BodyMedium::make_state(int seats) const {
  std::vector<BodyWorld::Probe> probes;
  if (!probe_bodies_.empty()) {
    for (const int body : probe_bodies_) probes.push_back({.body = body});
    return std::make_unique<BodyWorld>(copy_of_model(), coupling_, std::move(probes));
  }
  ModelPointer model = seats == 1 ? copy_of_model() : compile_mjcf(to_mjcf(description_, seats), name_);
  for (int i = 0; i < seats; ++i) {
    const int body = mj_name2id(model.get(), mjOBJ_BODY, ("probe " + std::to_string(i)).c_str());
    probes.push_back({.body = body, .slides = model->jnt_qposadr[model->body_jntadr[body]]});
  }
  return std::make_unique<BodyWorld>(std::move(model), coupling_, std::move(probes));
}

MediumFacts BodyMedium::facts() const {
  const bool ours = probe_bodies_.empty();
  const double mass_kg = ours ? description_.probe.mass_kg : model_->body_subtreemass[probe_bodies_.front()];
  const double load = coupling_.load(mass_kg, model_->opt.timestep);
  MediumFacts facts{.memory_bytes = bytes_of(*model_),
                    .state_bytes = bytes_of(*model_) + static_cast<std::size_t>(model_->nstack) * sizeof(mjtNum),
                    .stiffness_N_per_m = coupling_.stiffness_N_per_m,
                    .cost_ns = 2000.0 + 1500.0 * model_->nv,
                    .inputs = {.velocity = true, .time = true}};
  facts.lines = {std::to_string(model_->nbody - 1) + " bodies, " + std::to_string(model_->nv) +
                     " degrees of freedom, by MuJoCo in steps of " + to_text(model_->opt.timestep) + " s",
                 "coupling " + to_text(coupling_.stiffness_N_per_m) + " N/m, " + to_text(coupling_.damping_N_s_per_m) +
                     " N s/m to a probe of " + to_text(mass_kg) + " kg: at " + to_text(std::round(1000 * load) / 10) +
                     " % of what is stable"};
  facts.on_surface_m = Eigen::Map<const Point>(model_->body_pos + 3 * (ours ? 1 : probe_bodies_.front()));
  if (!ours) facts.seats_max = static_cast<int>(probe_bodies_.size());
  return facts;
}

}  // namespace forcebound::server
