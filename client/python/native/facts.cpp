#include <cmath>
#include <limits>
#include <utility>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/device/device_description.hpp"
#include "python/native/bindings.hpp"
#include "python/native/facts_check.hpp"
#include "python/native/fields.hpp"

namespace forcebound::python {

namespace {

using control::Bracket;
using control::DeviceFacts;
using control::Uncertainty;

Bracket bracket_from(py::handle value, const char* name) {
  const Vector pair = vector_from(value, 2, name);
  return {pair[0], pair[1]};
}

py::object pair_of(const Bracket& bracket) { return py::make_tuple(bracket.least, bracket.most); }

template <Bracket Uncertainty::*kMember>
Field<Uncertainty> bracket_field(const char* name, const char* doc) {
  return {name, doc, [](const Uncertainty& u) { return pair_of(u.*kMember); },
          [](Uncertainty& u, py::handle value, const char* of) { u.*kMember = bracket_from(value, of); }};
}

/// A number for each joint.
template <Vector DeviceFacts::*kMember>
Field<DeviceFacts> joint_field(const char* name, const char* doc) {
  return {name, doc, [](const DeviceFacts& f) -> py::object { return read_only(f.*kMember); },
          [](DeviceFacts& f, py::handle value, const char* of) { f.*kMember = per_row_from(value, f.joints(), of); }};
}

const std::vector<Field<Uncertainty>>& uncertainty_fields() {
  static const std::vector<Field<Uncertainty>> kFields{
      bracket_field<&Uncertainty::stamp_s>("stamp_s",
                                           "A reading was latched so long after its stamp: (least, most) [s]."),
      bracket_field<&Uncertainty::latency_s>("latency_s",
                                             "The latency is longer than the facts' by (least, most) [s]."),
      bracket_field<&Uncertainty::latency_offset_s>("latency_offset_s",
                                                    "And by one constant within (least, most) [s]."),
      bracket_field<&Uncertainty::hold_s>(
          "hold_s", "Each stage of the release comes later than the facts say by (least, most) [s]."),
      number_field<&Uncertainty::clock_share>("clock_share", "The clock of the stamps is off by up to this share."),
      number_field<&Uncertainty::encoder_steps>("encoder_steps",
                                                "A reading is off by so many steps beyond half a step."),
      number_field<&Uncertainty::damping_share>("damping_share", "The damping is smaller by up to this share."),
      number_field<&Uncertainty::friction_share>("friction_share", "The friction is smaller by up to this share."),
      bracket_field<&Uncertainty::torque_gain_share>(
          "torque_gain_share", "Each motor's torque is the command times a constant, 1 and (least, most) more."),
      flag_field<&Uncertainty::losses_with_gain>(
          "losses_with_gain",
          "Damping and friction are told in units of the commands: a motor's constant times these."),
      number_field<&Uncertainty::torque_ripple_share>(
          "torque_ripple_share", "And off by up to this share of that, another one at each instant."),
      number_field<&Uncertainty::actuator_lag_s>("actuator_lag_s",
                                                 "Time constant of a first-order lag of the torque, at most [s]."),
  };
  return kFields;
}

void set_damping(DeviceFacts& facts, py::handle value, const char* name) {
  const py::array array = doubles_from(value, name);
  if (array.ndim() != 2) {
    facts.damping = any_vector_from(array, name).asDiagonal();
    return;
  }
  if (array.shape(0) < 1 || array.shape(0) > control::kDofMax) {
    throw py::value_error(std::string(name) + ": expected 1 to 6 rows, got " + std::to_string(array.shape(0)));
  }
  facts.damping = matrix_from(array, array.shape(0), array.shape(0), name);
}

const std::vector<Field<DeviceFacts>>& facts_fields() {
  static const std::vector<Field<DeviceFacts>> kFields{
      {"name", "Of the device.", [](const DeviceFacts& f) -> py::object { return py::str(f.name); },
       [](DeviceFacts& f, py::handle value, const char*) { f.name = value.cast<std::string>(); }},
      {"damping", "Lower bound of the damping, (joints, joints) [N s/m] or [N m s/rad]; positive definite.",
       [](const DeviceFacts& f) -> py::object { return read_only(f.damping); }, set_damping},
      flag_field<&DeviceFacts::cartesian>("cartesian", "The joints are the axes of the tip."),
      {"tip_axes", "Degrees of freedom of the tip where the joints are more; 0: as many as joints.",
       [](const DeviceFacts& f) -> py::object { return py::int_(f.tip_axes); },
       [](DeviceFacts& f, py::handle value, const char*) { f.tip_axes = value.cast<int>(); }},
      number_field<&DeviceFacts::period_s>("period_s", "Nominal length of a tick [s]."),
      joint_field<&DeviceFacts::friction>("friction", "Lower bound of the Coulomb friction, (joints,) [N] or [N m]."),
      joint_field<&DeviceFacts::encoder_step>(
          "encoder_step", "Distance of two neighbouring readings, (joints,) [m] or [rad]; 0: ideal."),
      joint_field<&DeviceFacts::actuator_step>(
          "actuator_step", "Distance of two neighbouring commands, (joints,) [N] or [N m]; 0: ideal."),
      number_field<&DeviceFacts::force_N_max>("force_N_max", "Largest force that the device may be asked for [N]."),
      number_field<&DeviceFacts::hold_s_max>("hold_s_max", "The device holds a force so long without a new one [s]."),
      number_field<&DeviceFacts::release_share>("release_share",
                                                "The release begins with this share of the force, 0 to 1."),
      number_field<&DeviceFacts::release_s>("release_s", "That share is held for so long [s]."),
      flag_field<&DeviceFacts::releases>("releases", "False: only the next command ends a force."),
      number_field<&DeviceFacts::latency_s>("latency_s", "From the command to the force at the actuator [s]."),
      {"speed_max", "No joint is ever faster, (joints,) [m/s] or [rad/s]; None: not known.",
       [](const DeviceFacts& f) -> py::object {
         if (f.speed_max.rows() == 0) return py::none();
         return read_only(f.speed_max);
       },
       [](DeviceFacts& f, py::handle value, const char*) {
         f.speed_max = value.is_none() ? Vector() : per_row_from(value, f.joints(), "speed_max");
       }},
      {"uncertainty", "How far the truth may be from these facts.",
       [](const DeviceFacts& f) { return py::cast(f.uncertainty); },
       [](DeviceFacts& f, py::handle value, const char*) { f.uncertainty = value.cast<Uncertainty>(); }},
  };
  return kFields;
}

/// The damping first: it says how many joints there are.
DeviceFacts changed(DeviceFacts facts, const py::kwargs& changes) {
  if (changes.contains("damping")) set_damping(facts, changes["damping"], "damping");
  set_fields(facts, changes, facts_fields(), "DeviceFacts");
  expect_possible(facts);
  return facts;
}

DeviceFacts facts_from(py::handle damping, const py::kwargs& others) {
  DeviceFacts facts;
  facts.name = "device";
  facts.force_N_max = std::numeric_limits<double>::infinity();
  set_damping(facts, damping, "damping");
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(facts.joints());
  return changed(std::move(facts), others);
}

}  // namespace

void bind_facts(py::module_& module) {
  py::class_<Uncertainty> uncertainty(module, "Uncertainty",
                                      "How far the truth may be from a device's facts and from the stamps of its "
                                      "readings; all 0: they are exact.");
  uncertainty.def(py::init([](const py::kwargs& fields) {
    Uncertainty made;
    set_fields(made, fields, uncertainty_fields(), "Uncertainty");
    return made;
  }));
  uncertainty.def("__eq__", [](const Uncertainty& a, const Uncertainty& b) { return a == b; });
  add_fields(uncertainty, uncertainty_fields());

  py::class_<DeviceFacts> facts(module, "DeviceFacts",
                                "What is known of a haptic device, and all that a law may rely on. Arrays have one row "
                                "per joint. Immutable; `replace` gives a changed copy.");
  facts.def(py::init(&facts_from), py::arg("damping"),
            "damping: a number, (joints,) or (joints, joints) [N s/m]; the others by their names, a number for all "
            "joints or one for each.\n\nRaises ValueError for a wrong shape or value, TypeError for a wrong dtype.");
  add_fields(facts, facts_fields());
  facts.def_property_readonly("joints", &DeviceFacts::joints, "Number of joints.");
  facts.def_property_readonly("degrees_of_freedom", &DeviceFacts::degrees_of_freedom,
                              "Rows of positions and forces of the tip.");
  facts.def("replace", &changed, "A copy with other values for the fields that are named.");
  facts.def("__repr__", [](const DeviceFacts& f) { return "DeviceFacts(" + device::describe(f) + ")"; });
}

}  // namespace forcebound::python
