#include <pybind11/stl.h>

#include <memory>

#include "forcebound/device/device_description.hpp"
#include "forcebound/device/kinematics/kinematics.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "python/native/arrays.hpp"
#include "python/native/bindings.hpp"
#include "python/native/facts_check.hpp"

namespace forcebound::python {
namespace {

using device::DeviceDescription;

/// Positions and Jacobians of the tip, for each row of joint readings.
py::tuple tip_of(const DeviceDescription& device, py::handle joints) {
  const auto kinematics = device::make_kinematics(device.geometry);
  const py::ssize_t joint_count = device.facts.joints();
  const py::ssize_t translations = device.facts.translations();
  const py::ssize_t axes = device.facts.degrees_of_freedom();
  const Rows rows(joints, {joint_count}, "joints");
  py::array_t<double> positions({rows.size(), translations});
  py::array_t<double> jacobians({rows.size(), axes, joint_count});
  auto position_at = positions.mutable_unchecked<2>();
  auto jacobian_at = jacobians.mutable_unchecked<3>();
  Vector joint(joint_count);
  for (py::ssize_t row = 0; row < rows.size(); ++row) {
    rows.read(row, joint);
    const Vector position = kinematics->position(joint);
    const Matrix jacobian = kinematics->jacobian(joint);
    for (py::ssize_t i = 0; i < translations; ++i) position_at(row, i) = position[i];
    for (py::ssize_t i = 0; i < axes; ++i) {
      for (py::ssize_t j = 0; j < joint_count; ++j) jacobian_at(row, i, j) = jacobian(i, j);
    }
  }
  return py::make_tuple(positions, jacobians);
}

py::array_t<double> joints_at(const DeviceDescription& device, py::handle position) {
  const Vector place = vector_from(position, device.facts.translations(), "position");
  return array_of(device::make_kinematics(device.geometry)->joints_at(place));
}

DeviceDescription with_facts(const DeviceDescription& before, const control::DeviceFacts& facts) {
  expect_same_mechanism(facts, before.facts);
  DeviceDescription after = before;
  after.facts = facts;
  return after;
}

}  // namespace

void bind_devices(py::module_& module) {
  py::class_<DeviceDescription>(module, "Device",
                                "A simulated device: the facts that a law may use, and the parameters of its motion. "
                                "Its damping and friction are the facts' bounds.")
      .def_property_readonly("name", [](const DeviceDescription& d) { return d.facts.name; })
      .def_property_readonly(
          "facts", [](const DeviceDescription& d) { return d.facts; }, "What a law may rely on.")
      .def_property_readonly(
          "inertia", [](const DeviceDescription& d) { return read_only(d.inertia); },
          "(joints, joints) [kg] or [kg m^2].")
      .def_property_readonly(
          "identified", [](const DeviceDescription& d) { return d.identified; },
          "False: the bounds of the real device were never measured.")
      .def("with_facts", &with_facts, py::arg("facts"),
           "The same device with other facts, of the same joints and axes.")
      .def("tip_of", &tip_of, py::arg("joints"),
           "joints (n, joints) -> positions (n, dof) [m], Jacobians (n, dof, joints) of the tip; where it turns, with "
           "three "
           "rows more for that.")
      .def("joints_at", &joints_at, py::arg("position"), "position (dof,) [m] -> joints (joints,) that bring it there.")
      .def("__repr__", [](const DeviceDescription& d) { return "Device(" + device::describe(d) + ")"; });
  module.def("load_device", &device::load_device, py::arg("name_or_file"));
  module.def("parse_device", &device::parse_device, py::arg("toml_text"), py::arg("place"));
  module.def("device_names", &device::shipped_device_names);
  module.def("hands_help", &device::operators_help);
}

}  // namespace forcebound::python
