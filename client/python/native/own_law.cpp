#include "python/native/own_law.hpp"

#include <utility>

#include "python/native/bindings.hpp"

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

void OwnLaw::pass(const char* what, const control::Motion& motion) noexcept {
  const py::gil_scoped_acquire gil;
  if (shared_->fault.kept()) return;
  try {
    MotionOfPython told{.motion = motion, .damping = motion.damping != nullptr ? motion.damping->matrix() : Matrix()};
    told.motion.damping = nullptr;
    shared_->object.attr(what)(std::move(told));
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

namespace {

template <auto kMember>
void add_value(py::class_<MotionOfPython>& motion, const char* name, const char* doc) {
  motion.def_property_readonly(
      name, [](const MotionOfPython& told) { return told.motion.*kMember; }, doc);
}

template <auto kMember>
void add_array(py::class_<MotionOfPython>& motion, const char* name, const char* doc) {
  motion.def_property_readonly(
      name, [](const MotionOfPython& told) { return array_of(told.motion.*kMember); }, doc);
}

}  // namespace

void bind_own_laws(py::module_& module) {
  using control::Motion;
  py::class_<MotionOfPython> motion(module, "Motion", "What a tick measured before it chooses a force.");
  add_value<&Motion::interval_s>(motion, "interval_s",
                                 "Measured length of the interval that ended with this reading [s]; 0 at first.");
  add_value<&Motion::latency_s>(motion, "latency_s",
                                "From the previous reading to the effect of the force chosen on it, by the facts [s].");
  add_value<&Motion::effect_s>(motion, "effect_s", "The same as the device reports it [s]; nan: it does not.");
  add_value<&Motion::held_s>(motion, "held_s",
                             "From latency_s until the device let go of the force [s]; inf: it did not.");
  add_value<&Motion::latency_s_max>(motion, "latency_s_max",
                                    "Longest time from this reading to the effect of the force now to be chosen [s].");
  add_value<&Motion::write_failed>(motion, "write_failed", "Whether the force was ever in effect is unknown.");
  add_array<&Motion::position>(motion, "position", "Of the tip (dof,) [m].");
  add_array<&Motion::joint>(motion, "joint", "Of the joints (joints,) [m] or [rad].");
  add_array<&Motion::jacobian>(motion, "jacobian", "d position / d joint (dof, joints).");
  motion.def_property_readonly(
      "damping",
      [](const MotionOfPython& told) -> py::object {
        if (told.damping.rows() == 0) return py::none();
        return array_of(told.damping);
      },
      "Lower bound of the damping at the tip (dof, dof) [N s/m].");
}

}  // namespace forcebound::python
