#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/control/force_bounded_leader.hpp"
#include "python/native/bindings.hpp"
#include "python/native/fields.hpp"
#include "python/native/own_hand.hpp"
#include "tests/tools/sim/simulated_leader.hpp"

namespace forcebound::python {
namespace {

using control::ForceBoundedLeader;
using control::LeaderFacts;
using control::LeaderJoint;

const std::vector<Field<LeaderJoint>>& servo_fields() {
  static const std::vector<Field<LeaderJoint>> kFields{
      {"name", "", [](const LeaderJoint& j) -> py::object { return py::str(j.name); },
       [](LeaderJoint& j, py::handle value, const char*) { j.name = value.cast<std::string>(); }},
      number_field<&LeaderJoint::damping_N_m_s_per_rad>("damping_N_m_s_per_rad", ""),
      number_field<&LeaderJoint::friction_N_m>("friction_N_m", ""),
      number_field<&LeaderJoint::encoder_step_rad>("encoder_step_rad", ""),
      number_field<&LeaderJoint::backlash_rad>("backlash_rad", ""),
      number_field<&LeaderJoint::torque_N_m_max>("torque_N_m_max", ""),
      number_field<&LeaderJoint::torque_step_N_m>("torque_step_N_m", ""),
      number_field<&LeaderJoint::torque_gain_share>("torque_gain_share", ""),
      number_field<&LeaderJoint::torque_ripple_share>("torque_ripple_share", ""),
      number_field<&LeaderJoint::speed_rad_per_s_max>("speed_rad_per_s_max", ""),
      number_field<&LeaderJoint::goal_stiffness_N_m_per_rad>("goal_stiffness_N_m_per_rad", ""),
      number_field<&LeaderJoint::goal_rad_least>("goal_rad_least", ""),
      number_field<&LeaderJoint::goal_rad_most>("goal_rad_most", ""),
  };
  return kFields;
}

const std::vector<Field<LeaderFacts>>& loop_fields() {
  static const std::vector<Field<LeaderFacts>> kFields{
      number_field<&LeaderFacts::period_s>("period_s", ""),
      number_field<&LeaderFacts::latency_s_max>("latency_s_max", ""),
      number_field<&LeaderFacts::read_s_max>("read_s_max", ""),
      number_field<&LeaderFacts::hold_s_max>("hold_s_max", ""),
      number_field<&LeaderFacts::watchdog_s_least>("watchdog_s_least", ""),
      number_field<&LeaderFacts::clock_share>("clock_share", ""),
      number_field<&LeaderFacts::memory_J>("memory_J", ""),
  };
  return kFields;
}

LeaderFacts facts_from(const py::list& servos, const py::kwargs& loop) {
  LeaderFacts facts;
  set_fields(facts, loop, loop_fields(), "ForceBoundedLeader");
  for (const py::handle servo : servos) {
    set_fields(facts.joints.emplace_back(), servo.cast<py::kwargs>(), servo_fields(), "Servo");
  }
  return facts;
}

/// A number for each joint, of which there may be more than a device has.
std::vector<double> numbers_from(py::handle value, std::size_t count, const char* name) {
  const py::array array = doubles_from(value, name);
  if (array.ndim() != 1 || array.shape(0) != static_cast<py::ssize_t>(count)) {
    throw py::value_error(std::string(name) + ": expected shape (" + std::to_string(count) + ",), got " +
                          shape_in_words({array.shape(), array.shape() + array.ndim()}));
  }
  const auto numbers = array.unchecked<double, 1>();
  std::vector<double> all(count);
  for (std::size_t i = 0; i < count; ++i) all[i] = numbers(static_cast<py::ssize_t>(i));
  return all;
}

py::array_t<double> step(ForceBoundedLeader& leader, py::handle positions, py::handle feedback, double interval_s) {
  const std::size_t joints = leader.joints();
  const std::vector<double> position_rad = numbers_from(positions, joints, "positions");
  std::vector<double> feedback_N_m;
  if (!feedback.is_none()) feedback_N_m = numbers_from(feedback, joints, "feedback");
  std::vector<double> torque(joints);
  leader.step(position_rad, feedback_N_m, interval_s, torque);
  return array_of(torque.data(), static_cast<Eigen::Index>(joints));
}

template <class Number>
py::array_t<double> of_each_joint(const ForceBoundedLeader& leader, Number&& number) {
  std::vector<double> all(leader.joints());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = number(i);
  return array_of(all.data(), static_cast<Eigen::Index>(all.size()));
}

py::dict counts_of(const ForceBoundedLeader& leader) {
  const ForceBoundedLeader::Counts c = leader.counts();
  py::dict counts;
  counts["readings_lost"] = c.readings_lost;
  counts["feedback_not_finite"] = c.feedback_not_finite;
  counts["intervals_impossible"] = c.intervals_impossible;
  counts["late"] = c.late;
  counts["writes_failed"] = c.writes_failed;
  counts["saturated"] = c.saturated;
  return counts;
}

/// sim::SimulatedLeader with a hand in Python.
class SimulatedArm {
 public:
  SimulatedArm(const py::list& servos, const py::kwargs& loop, py::handle inertia_kg_m2, py::handle hand,
               std::uint64_t seed)
      : hand_(own_hand_from(hand)), arm_(make(facts_from(servos, loop), inertia_kg_m2, hand_, seed)) {
    hand_->fault.rethrow();
  }

  py::array_t<double> read(double time_s) {
    const Vector position = arm_.read(forward(time_s, "time_s"));
    hand_->fault.rethrow();
    return array_of(position);
  }
  void write(double time_s, py::handle torques) {
    const Vector torque_N_m = vector_from(torques, arm_.truth().joint.rows(), "torques");
    if (!torque_N_m.allFinite()) throw py::value_error("torques must be finite");
    arm_.write(forward(time_s, "time_s"), torque_N_m);
    hand_->fault.rethrow();
  }
  [[nodiscard]] const sim::SimulatedLeader& arm() const noexcept { return arm_; }

 private:
  static sim::SimulatedLeader make(const LeaderFacts& facts, py::handle inertia_kg_m2,
                                   const std::shared_ptr<OwnHand::Shared>& hand, std::uint64_t seed) {
    const auto joints = static_cast<int>(facts.joints.size());
    if (joints > control::kDofMax) {
      throw py::value_error("a simulated leader has 1 to 6 joints, got " + std::to_string(joints));
    }
    return {facts, per_row_from(inertia_kg_m2, joints, "inertia_kg_m2"), std::make_unique<OwnHand>(hand, joints), seed};
  }
  time::Nanoseconds forward(double time_s, const char* name) {
    const time::Nanoseconds time = time::from_seconds(seconds_from(py::float_(time_s), name));
    if (time < now_) throw py::value_error(std::string(name) + " must not be before the time of the call before");
    return now_ = time;
  }

  std::shared_ptr<OwnHand::Shared> hand_;
  sim::SimulatedLeader arm_;
  time::Nanoseconds now_{0};
};

py::dict truth_of(const SimulatedArm& simulated) {
  const device::SimulatedDevice::Truth truth = simulated.arm().truth();
  py::dict all;
  all["joint"] = array_of(truth.joint);
  all["joint_velocity"] = array_of(truth.joint_velocity);
  return all;
}

}  // namespace

void bind_leader(py::module_& module) {
  py::class_<ForceBoundedLeader>(module, "Leader")
      .def(py::init([](const py::list& servos, const py::kwargs& loop) {
             return std::make_unique<ForceBoundedLeader>(facts_from(servos, loop));
           }),
           py::arg("servos"))
      .def("step", &step, py::arg("positions"), py::arg("feedback").none(true), py::arg("interval_s"))
      .def("lose", &ForceBoundedLeader::lose, py::arg("interval_s"))
      .def("report_failed_write", &ForceBoundedLeader::report_failed_write)
      .def_property_readonly(
          "goals_rad",
          [](const ForceBoundedLeader& l) { return of_each_joint(l, [&](std::size_t i) { return l.goal_rad(i); }); })
      .def_property_readonly(
          "energy_J",
          [](const ForceBoundedLeader& l) { return of_each_joint(l, [&](std::size_t i) { return l.energy_J(i); }); })
      .def_property_readonly("counts", &counts_of)
      .def_property_readonly("fault", &ForceBoundedLeader::fault_in_words)
      .def_property_readonly("hold_s_max", [](const ForceBoundedLeader& l) { return l.facts().hold_s_max; });
  py::class_<SimulatedArm>(module, "SimulatedLeader")
      .def(py::init([](const py::list& servos, py::handle inertia_kg_m2, py::handle hand, std::uint64_t seed,
                       const py::kwargs& loop) {
             return std::make_unique<SimulatedArm>(servos, loop, inertia_kg_m2, hand, seed);
           }),
           py::arg("servos"), py::arg("inertia_kg_m2"), py::arg("hand"), py::arg("seed"))
      .def("read", &SimulatedArm::read, py::arg("time_s"))
      .def("write", &SimulatedArm::write, py::arg("time_s"), py::arg("torques"))
      .def_property_readonly("P_J", [](const SimulatedArm& a) { return a.arm().audit().energy_J; })
      .def_property_readonly("least_P_J", [](const SimulatedArm& a) { return a.arm().audit().minimum_J; })
      .def_property_readonly("truth", &truth_of);
}

}  // namespace forcebound::python
