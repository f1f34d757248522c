#include "forcebound/server/bodies/body_medium.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>

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
  check_coupling(description_.probe.mass_kg, description_.timestep_s);
}

BodyMedium::BodyMedium(ModelPointer model, const std::string& probe, const Coupling& coupling, std::string name)
    : name_(std::move(name)),
      coupling_(coupling),
      model_(std::move(model)),
      probe_body_(find_body(*model_, probe, name_)) {
  const double mass_kg = model_->body_subtreemass[probe_body_];
  if (!(mass_kg > 0)) throw BodiesError(name_ + ": body '" + probe + "' must have a mass to be the probe");
  check_coupling(mass_kg, model_->opt.timestep);
}

void BodyMedium::check_coupling(double mass_kg, double step_s) const {
  const double load = coupling_.load(mass_kg, step_s);
  if (load < 1) return;
  throw BodiesError(name_ + ": the probe's coupling of " + to_text(coupling_.stiffness_N_per_m) + " N/m and " +
                    to_text(coupling_.damping_N_s_per_m) + " N s/m is unstable with a mass of " + to_text(mass_kg) +
                    " kg in steps of " + to_text(step_s) + " s (" + to_text(load) +
                    " of what is stable): take a softer one, a heavier probe or shorter steps");
}

ModelPointer BodyMedium::copy_of_model() const { return ModelPointer(mj_copyModel(nullptr, model_.get())); }

std::unique_ptr<MediumState> BodyMedium::make_state(int seats) const {
  if (probe_body_ > 0) {
    return std::make_unique<BodyWorld>(copy_of_model(), coupling_,
                                       std::vector<BodyWorld::Probe>{{.body = probe_body_}});
  }
  ModelPointer model = seats == 1 ? copy_of_model() : compile_mjcf(to_mjcf(description_, seats), name_);
  std::vector<BodyWorld::Probe> probes;
  for (int i = 0; i < seats; ++i) {
    const int body = mj_name2id(model.get(), mjOBJ_BODY, ("probe " + std::to_string(i)).c_str());
    probes.push_back({.body = body, .slides = model->jnt_qposadr[model->body_jntadr[body]]});
  }
  return std::make_unique<BodyWorld>(std::move(model), coupling_, std::move(probes));
}

MediumFacts BodyMedium::facts() const {
  const double mass_kg = probe_body_ > 0 ? model_->body_subtreemass[probe_body_] : description_.probe.mass_kg;
  const double load = coupling_.load(mass_kg, model_->opt.timestep);
  MediumFacts facts{.memory_bytes = bytes_of(*model_),
                    .state_bytes = bytes_of(*model_) + static_cast<std::size_t>(model_->nstack) * sizeof(mjtNum),
                    .stiffness_N_per_m = coupling_.stiffness_N_per_m,
                    .cost_ns = 2000.0 + 1500.0 * model_->nv};
  facts.lines = {std::to_string(model_->nbody - 1) + " bodies, " + std::to_string(model_->nv) +
                     " degrees of freedom, by MuJoCo in steps of " + to_text(model_->opt.timestep) + " s",
                 "coupling " + to_text(coupling_.stiffness_N_per_m) + " N/m, " + to_text(coupling_.damping_N_s_per_m) +
                     " N s/m to a probe of " + to_text(mass_kg) + " kg: at " + to_text(load) + " of what is stable"};
  facts.on_surface_m = Eigen::Map<const Point>(model_->body_pos + 3 * std::max(probe_body_, 1));
  return facts;
}

}  // namespace forcebound::server
