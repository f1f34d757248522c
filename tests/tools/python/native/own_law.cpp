#include "tests/tools/python/native/own_law.hpp"

#include "tests/tools/python/native/bindings.hpp"

namespace forcebound::python {

Vector OwnLaw::bound(const Vector& request_N) noexcept {
  const py::gil_scoped_acquire gil;
  const Vector zero = Vector::Zero(request_N.rows());
  if (shared_->fault.kept()) return zero;
  try {
    const py::object force_N = shared_->object.attr("bound")(array_of(request_N));
    return vector_from(force_N, request_N.rows(), "the force of an own law");
  } catch (...) {
    shared_->fault.keep(std::current_exception());
    return zero;
  }
}

void OwnLaw::commit(const Vector& force_N) noexcept {
  const py::gil_scoped_acquire gil;
  if (shared_->fault.kept()) return;
  try {
    shared_->object.attr("commit")(array_of(force_N));
  } catch (...) {
    shared_->fault.keep(std::current_exception());
  }
}

void OwnLaw::tell(const char* what, const control::Motion& motion) noexcept {
  const py::gil_scoped_acquire gil;
  if (shared_->fault.kept()) return;
  try {
    shared_->object.attr(what)(motion);
  } catch (...) {
    shared_->fault.keep(std::current_exception());
  }
}

double OwnLaw::number(const char* attribute, double otherwise) const noexcept {
  const py::gil_scoped_acquire gil;
  if (shared_->fault.kept()) return otherwise;
  try {
    return shared_->object.attr(attribute).cast<double>();
  } catch (...) {
    shared_->fault.keep(std::current_exception());
    return otherwise;
  }
}

void add_own_law(control::LawRegistry& laws, const std::shared_ptr<OwnLaw::Shared>& shared) {
  laws.add({.name = shared->name,
            .summary = "a law in Python",
            .make = [shared](const control::DeviceFacts& facts, const control::LawOptions&) {
              const py::gil_scoped_acquire gil;
              shared->object.attr("begin")(facts);
              return std::make_unique<OwnLaw>(shared);
            }});
}

void bind_own_laws(py::module_& module) {
  py::class_<control::Motion> motion(module, "Motion", "What a tick measured before it chooses a force.");
  motion.def_readonly("interval_s", &control::Motion::interval_s,
                      "Measured length of the interval that ended with this reading [s]; 0 at first.");
  motion.def_readonly("latency_s", &control::Motion::latency_s,
                      "From the previous reading to the effect of the force chosen on it, by the facts [s].");
  motion.def_readonly("effect_s", &control::Motion::effect_s,
                      "The same as the device reports it [s]; nan: it does not.");
  motion.def_readonly("held_s", &control::Motion::held_s,
                      "From latency_s until the device let go of the force [s]; inf: it did not.");
  motion.def_readonly("latency_s_max", &control::Motion::latency_s_max,
                      "Longest time from this reading to the effect of the force now to be chosen [s].");
  motion.def_readonly("write_failed", &control::Motion::write_failed,
                      "Whether the force was ever in effect is unknown.");
  motion.def_property_readonly(
      "position", [](const control::Motion& m) { return array_of(m.position); }, "Of the tip (dof,) [m].");
  motion.def_property_readonly(
      "joint", [](const control::Motion& m) { return array_of(m.joint); }, "Of the joints (joints,) [m] or [rad].");
  motion.def_property_readonly(
      "jacobian", [](const control::Motion& m) { return array_of(m.jacobian); }, "d position / d joint (dof, joints).");
  motion.def_property_readonly(
      "damping",
      [](const control::Motion& m) -> py::object {
        if (m.damping == nullptr) return py::none();
        return array_of(m.damping->matrix());
      },
      "Lower bound of the damping at the tip (dof, dof) [N s/m], while the motion is told.");
}

}  // namespace forcebound::python
