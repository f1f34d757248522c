#include "tests/tools/lab/accuracy/body_watch.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "forcebound/server/dynamics/bodies/body_world.hpp"

namespace forcebound::lab {
namespace {

using scene::Point;
using server::BodyWorld;

Point at(const mjtNum* vectors, int index) { return Eigen::Map<const Point>(vectors + 3 * index); }

/// A direction of the world in a body's frame, and the reverse.
Point to_body(const mjData& data, int body, const Point& direction) {
  Point local;
  mju_rotVecMatT(local.data(), direction.data(), data.xmat + 9 * body);
  return local;
}
Point from_body(const mjData& data, int body, const Point& local) {
  Point direction;
  mju_rotVecMat(direction.data(), local.data(), data.xmat + 9 * body);
  return direction;
}

std::string name_of(const mjModel& model, int body) {
  const char* const name = mj_id2name(&model, mjOBJ_BODY, body);
  return name != nullptr ? name : "body " + std::to_string(body);
}

double radius_m(const mjModel& model, int body) {
  double most = 0;
  for (int i = 0; i < model.ngeom; ++i) {
    if (model.geom_bodyid[i] == body) most = std::max(most, model.geom_rbound[i]);
  }
  return most;
}

double half_thickness_m(const mjModel& model, int geom) {
  switch (model.geom_type[geom]) {
    case mjGEOM_SPHERE:
    case mjGEOM_CAPSULE:
      return model.geom_size[3 * geom];
    case mjGEOM_CYLINDER:
      return std::min(model.geom_size[3 * geom], model.geom_size[3 * geom + 1]);
    case mjGEOM_BOX:
    case mjGEOM_ELLIPSOID:
      return at(model.geom_size, geom).minCoeff();
    case mjGEOM_PLANE:
    case mjGEOM_HFIELD:
      return std::numeric_limits<double>::infinity();
    default:
      return model.geom_rbound[geom];
  }
}

double half_thickness_of_body_m(const mjModel& model, int body) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < model.ngeom; ++i) {
    if (model.geom_bodyid[i] == body) least = std::min(least, half_thickness_m(model, i));
  }
  return least;
}

bool is_round(const mjModel& model, int body) {
  for (int i = 0; i < model.ngeom; ++i) {
    if (model.geom_bodyid[i] == body && model.geom_type[i] != mjGEOM_SPHERE) return false;
  }
  return true;
}

/// Whether a joint moves it, or its parent.
bool moves(const mjModel& model, int body) { return model.body_weldid[body] != 0; }

}  // namespace

struct BodyWatch::Watched {
  Watched(scene::DynamicModelsNow held, const BodyWorld& of)
      : dynamic_models(std::move(held)), world(of), model(server::copy_of(of.model())), time_s(of.data().time) {
    model->opt.enableflags |= mjENBL_ENERGY;
    look = server::make_data(*model);
  }

  scene::DynamicModelsNow dynamic_models;  ///< keeps the world alive
  const BodyWorld& world;
  server::ModelPointer model;  ///< its own, which counts energy
  server::DataPointer look;    ///< at the same positions as the world, with all derived quantities
  double time_s;
  double begin_J = 0;
  double put_in_J = 0;
  std::vector<Point> velocities{};
  std::vector<Point> forces{};
  std::vector<Point> up{};  ///< in each body's frame
  BodyRecord record{};
};

const BodyWorld* body_world(const scene::DynamicModelsNow& dynamic_models, std::size_t dynamic_model) {
  return dynamic_cast<const BodyWorld*>(&dynamic_models[dynamic_model]->state());
}

BodyWatch::BodyWatch(const scene::SceneState& state) {
  const scene::DynamicModelsNow dynamic_models = state.dynamic_models();
  for (std::size_t i = 0; i < dynamic_models.size(); ++i) {
    const BodyWorld* const world = body_world(dynamic_models, i);
    if (world == nullptr) continue;
    worlds_.push_back(std::make_unique<Watched>(dynamic_models, *world));
    Watched& watched = *worlds_.back();
    const mjModel& model = world->model();
    watched.record.is_driven = model.nu > 0;
    for (int body = 0; body < model.nbody; ++body) {
      watched.up.push_back(to_body(*watched.look, body, Point::UnitZ()));
      if (moves(model, body)) {
        watched.record.weight_J += model.body_mass[body] * mju_norm3(model.opt.gravity) * radius_m(model, body);
      }
    }
  }
}

BodyWatch::~BodyWatch() = default;

bool BodyWatch::observe() {
  bool stepped = worlds_.empty();
  for (const auto& watched : worlds_) {
    const double elapsed_s = watched->world.data().time - watched->time_s;
    if (!watched->world.sound() || (!(elapsed_s > 0) && !watched->forces.empty())) continue;
    stepped = stepped || elapsed_s > 0;
    look(*watched);
    account(*watched, elapsed_s);
    watched->time_s += elapsed_s;
  }
  return stepped;
}

void BodyWatch::look(Watched& watched) {
  const mjModel& model = watched.world.model();
  const mjData& data = watched.world.data();
  mjData& look = *watched.look;
  mju_copy(look.qpos, data.qpos, model.nq);
  mju_copy(look.qvel, data.qvel, model.nv);
  server::forward(*watched.model, look);
  for (int i = 0; i < look.ncon; ++i) {
    const mjContact& contact = look.contact[i];
    const double thinner_m = std::min(half_thickness_m(model, contact.geom1), half_thickness_m(model, contact.geom2));
    BodyRecord& record = watched.record;
    record.deepest_m = std::max(record.deepest_m, -contact.dist);
    record.deepest_of_thickness = std::max(record.deepest_of_thickness, -contact.dist / thinner_m);
  }
}

void BodyWatch::account(Watched& watched, double elapsed_s) {
  const mjModel& model = watched.world.model();
  const mjData& data = watched.world.data();
  const mjData& look = *watched.look;
  BodyRecord& record = watched.record;
  std::vector<Point> velocities;
  std::vector<Point> forces;
  for (int body = 0; body < model.nbody; ++body) {
    mjtNum velocity[6];
    mj_objectVelocity(&model, &look, mjOBJ_BODY, body, velocity, 0);
    velocities.emplace_back(velocity[3], velocity[4], velocity[5]);
    forces.emplace_back(Eigen::Map<const Point>(data.xfrc_applied + 6 * body));
  }
  const double held_J = look.energy[0] + look.energy[1];
  if (watched.forces.empty()) {
    watched.begin_J = held_J;
  } else {
    const bool several = elapsed_s > 1.5 * model.opt.timestep;
    double work_J = 0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const Point force_N = several ? Point(0.5 * (forces[i] + watched.forces[i])) : forces[i];
      work_J += 0.5 * elapsed_s * force_N.dot(velocities[i] + watched.velocities[i]);
    }
    watched.put_in_J += work_J;
    record.turned_over_J += std::abs(work_J);
    ++record.ticks;
    if (data.solver_iter >= model.opt.iterations) ++record.exhausted;
  }
  record.drift_J = held_J - watched.begin_J - watched.put_in_J;
  record.gained_J = std::max(record.gained_J, record.drift_J);
  watched.velocities = std::move(velocities);
  watched.forces = std::move(forces);
}

BodyRecord BodyWatch::record() const {
  BodyRecord all;
  for (const auto& watched : worlds_) {
    const BodyRecord& one = watched->record;
    const mjModel& model = watched->world.model();
    const mjData& look = *watched->look;
    all.gained_J += one.gained_J;
    all.drift_J += one.drift_J;
    all.turned_over_J += one.turned_over_J;
    all.weight_J += one.weight_J;
    all.is_driven = all.is_driven || one.is_driven;
    all.deepest_m = std::max(all.deepest_m, one.deepest_m);
    all.deepest_of_thickness = std::max(all.deepest_of_thickness, one.deepest_of_thickness);
    all.ticks += one.ticks;
    all.exhausted += one.exhausted;
    for (int kind = 0; kind < mjNWARNING; ++kind) {
      const mjWarningStat& warning = watched->world.data().warning[kind];
      if (warning.number > 0) all.warnings[mju_warningText(kind, warning.lastinfo)] += warning.number;
    }
    for (int body = 1; body < model.nbody; ++body) {
      if (!moves(model, body)) continue;
      all.places.push_back({name_of(model, body), at(look.xipos, body),
                            from_body(look, body, watched->up[static_cast<std::size_t>(body)]), radius_m(model, body),
                            half_thickness_of_body_m(model, body), is_round(model, body)});
    }
  }
  return all;
}

}  // namespace forcebound::lab
