#include "forcebound/server/robot/arm_mjcf.hpp"

#include <mujoco/mujoco.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"
#include "forcebound/server/dynamics/bodies/visible_geometries.hpp"
#include "forcebound/server/robot/shipped_robots.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr std::string_view kArm = "reach_7";
constexpr std::string_view kBlockPlace = "<!-- block -->";
constexpr const char* kBlock = "block";
constexpr const char* kTool = "tool";
constexpr const char* kToolBody = "gripper";

// Of joint and finger alike: see the file.
constexpr int kUsers = 4;

std::string three(const Eigen::Vector3d& v) {
  return text::to_text(v.x()) + " " + text::to_text(v.y()) + " " + text::to_text(v.z());
}

std::string block_mjcf(const WorldObject& block) {
  const Eigen::Vector3d square = block.half_size.cwiseAbs2();
  const Eigen::Vector3d inertia = block.mass_kg / 3 * (Eigen::Vector3d::Constant(square.sum()) - square);
  return R"(<body name="block" pos=")" + three(block.position) + R"("><inertial pos="0 0 0" mass=")" +
         text::to_text(block.mass_kg) + R"(" diaginertia=")" + three(inertia) +
         R"("/><joint name="block" type="free"/></body>)";
}

std::span<const double> users_of(const mjModel& model, int joint) {
  return {model.jnt_user + static_cast<std::ptrdiff_t>(joint) * model.nuser_jnt, kUsers};
}

Eigen::Vector3d vector_at(const double* numbers, int number) {
  return Eigen::Map<const Eigen::Vector3d>(numbers + static_cast<std::ptrdiff_t>(3) * number);
}

Eigen::Quaterniond turn_at(const double* numbers, int number) {
  const double* q = numbers + static_cast<std::ptrdiff_t>(4) * number;
  return {q[0], q[1], q[2], q[3]};
}

Eigen::Isometry3d frame_of(const double* positions, const double* turns, int number) {
  return Eigen::Translation3d(vector_at(positions, number)) * turn_at(turns, number);
}

int found(const mjModel& model, int kind, const char* name) {
  const int number = mj_name2id(&model, kind, name);
  if (number < 0) throw std::runtime_error("the arm's MJCF has no '" + std::string(name) + "'");
  return number;
}

/// Adds a body's mass to the link that it is fixed to, `from_link` being its frame there.
void add_mass(ChainLink& link, const mjModel& model, int body, const Eigen::Isometry3d& from_link) {
  const Eigen::Isometry3d own = from_link * frame_of(model.body_ipos, model.body_iquat, body);
  const double mass_kg = model.body_mass[body];
  const Eigen::Matrix3d turn = own.linear();
  const auto about = [](double mass, const Eigen::Vector3d& apart) -> Eigen::Matrix3d {
    return mass * (apart.squaredNorm() * Eigen::Matrix3d::Identity() - apart * apart.transpose());
  };
  const double total_kg = link.mass_kg + mass_kg;
  const Eigen::Vector3d apart = own.translation() - link.centre;
  link.inertia += turn * vector_at(model.body_inertia, body).asDiagonal() * turn.transpose();
  link.inertia += about(link.mass_kg * mass_kg / total_kg, apart);
  link.centre += mass_kg / total_kg * apart;
  link.mass_kg = total_kg;
}

/// How the parts of the arm look.
std::vector<LinkShape> shapes_of(const mjModel& model, const mjData& start, const std::vector<int>& link_of_body,
                                 const std::vector<Eigen::Isometry3d>& frames) {
  std::vector<LinkShape> shapes;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const int body = model.geom_bodyid[geom];
    const char* const name = mj_id2name(&model, mjOBJ_GEOM, geom);
    if (name == nullptr) throw std::runtime_error("the arm's MJCF: each geom must have a name");
    auto part = shape_of(model, geom);
    if (!part)
      throw std::runtime_error("the arm's MJCF: geom '" + std::string(name) + "' must be of a kind that is drawn");
    part->name = name;
    LinkShape shape{.part = *std::move(part), .link = link_of_body[static_cast<std::size_t>(body)]};
    const Eigen::Isometry3d place =
        frame_of(start.xpos, start.xquat, body) * frame_of(model.geom_pos, model.geom_quat, geom);
    shape.in_link = shape.link < 0 ? place : frames[static_cast<std::size_t>(shape.link)].inverse() * place;
    if (const int joint = model.body_jntadr[body]; joint >= 0 && model.jnt_type[joint] == mjJNT_SLIDE) {
      const double travel_m = model.jnt_range[static_cast<std::ptrdiff_t>(2) * joint + 1];
      const Eigen::Vector3d way = turn_at(start.xquat, body) * vector_at(model.jnt_axis, joint);
      shape.opens_m = travel_m * (frames[static_cast<std::size_t>(shape.link)].linear().transpose() * way);
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace

std::string arm_mjcf(const Task::World& world) {
  std::string mjcf;
  for (const text::EmbeddedText& robot : shipped_robots()) {
    if (robot.name == kArm) mjcf = robot.text;
  }
  const std::size_t at = mjcf.find(kBlockPlace);
  if (at == std::string::npos) throw std::runtime_error("the arm's MJCF has no place for a block");
  const WorldObject* block = world.find(WorldObject::Shape::block);
  return mjcf.replace(at, kBlockPlace.size(), block == nullptr ? "" : block_mjcf(*block));
}

ArmLayout layout_of(const mjModel& model) {
  if (model.nuser_jnt != kUsers) throw std::runtime_error("the arm's MJCF must have 4 numbers of a joint's own");
  ArmLayout layout;
  layout.tool_body = found(model, mjOBJ_BODY, kToolBody);
  layout.tool_site = found(model, mjOBJ_SITE, kTool);
  while (layout.joints < model.njnt && model.jnt_type[layout.joints] == mjJNT_HINGE) ++layout.joints;
  for (int joint = layout.joints; joint < model.njnt; ++joint) {
    if (model.jnt_type[joint] != mjJNT_SLIDE) continue;
    const auto users = users_of(model, joint);
    layout.fingers.push_back({.position = model.jnt_qposadr[joint],
                              .speed = model.jnt_dofadr[joint],
                              .travel_m = model.jnt_range[static_cast<std::ptrdiff_t>(2) * joint + 1],
                              .force_N_max = users[0],
                              .stiffness_N_per_m = users[1],
                              .damping_N_s_per_m = users[2]});
  }
  if (const int joint = mj_name2id(&model, mjOBJ_JOINT, kBlock); joint >= 0) {
    layout.block_body = model.jnt_bodyid[joint];
    layout.block_position = model.jnt_qposadr[joint];
    layout.block_speed = model.jnt_dofadr[joint];
  }
  return layout;
}

SerialChain chain_of(const mjModel& model, const ArmLayout& layout) {
  const DataPointer start = make_data(model);
  SerialChain::Description chain;
  chain.name = "reach-7";
  const auto joints = static_cast<Eigen::Index>(layout.joints);
  RobotLimits& limits = chain.limits;
  for (Vector* rows : {&limits.lowest, &limits.highest, &limits.speed_max, &limits.torque_max, &chain.rest}) {
    rows->setZero(joints);
  }
  std::vector<int> link_of_body(static_cast<std::size_t>(model.nbody), -1);
  std::vector<Eigen::Isometry3d> frames;
  for (int joint = 0; joint < layout.joints; ++joint) {
    const int body = model.jnt_bodyid[joint];
    link_of_body[static_cast<std::size_t>(body)] = joint;
    frames.push_back(frame_of(start->xpos, start->xquat, body));
    ChainLink link;
    link.from_before = joint == 0 ? frames.back() : frames[frames.size() - 2].inverse() * frames.back();
    link.axis = vector_at(model.jnt_axis, joint);
    link.rotor_kg_m2 = model.dof_armature[joint];
    chain.links.push_back(link);
    limits.lowest[joint] = model.jnt_range[static_cast<std::ptrdiff_t>(2) * joint];
    limits.highest[joint] = model.jnt_range[static_cast<std::ptrdiff_t>(2) * joint + 1];
    limits.torque_max[joint] = users_of(model, joint)[1];
    limits.speed_max[joint] = users_of(model, joint)[2];
    chain.rest[joint] = users_of(model, joint)[3];
  }
  // A body comes after its parent.
  for (int body = 1; body < model.nbody; ++body) {
    int& number = link_of_body[static_cast<std::size_t>(body)];
    if (number < 0) number = link_of_body[static_cast<std::size_t>(model.body_parentid[body])];
    if (number < 0) continue;  // the block
    const auto link = static_cast<std::size_t>(number);
    add_mass(chain.links[link], model, body, frames[link].inverse() * frame_of(start->xpos, start->xquat, body));
  }
  const Eigen::Isometry3d tool =
      Eigen::Translation3d(vector_at(start->site_xpos, layout.tool_site)) * turn_at(start->xquat, layout.tool_body);
  chain.tool = frames.back().inverse() * tool;
  chain.shapes = shapes_of(model, *start, link_of_body, frames);
  limits.tool_speed_m_per_s_max = 1;
  limits.tool_turn_rad_per_s_max = 2.5;
  return SerialChain(std::move(chain));
}

control::DeviceFacts facts_of(const mjModel& model, const ArmLayout& layout) {
  const auto joints = static_cast<Eigen::Index>(layout.joints);
  control::DeviceFacts facts;
  facts.name = "reach-7";
  facts.damping = Matrix::Zero(joints, joints);
  facts.friction = Vector::Zero(joints);
  facts.encoder_step = Vector::Zero(joints);
  facts.actuator_step = Vector::Zero(joints);
  Vector torque_max = Vector::Zero(joints);
  for (int joint = 0; joint < layout.joints; ++joint) {
    facts.damping(joint, joint) = model.dof_damping[joint];
    facts.friction[joint] = model.dof_frictionloss[joint];
    facts.encoder_step[joint] = 2 * std::numbers::pi / std::exp2(users_of(model, joint)[0]);
    torque_max[joint] = users_of(model, joint)[1];
  }
  facts.force_N_max = torque_max.norm();
  facts.hold_s_max = 2e-3;
  facts.latency_s = 3e-4;
  return facts;
}

}  // namespace forcebound::server
