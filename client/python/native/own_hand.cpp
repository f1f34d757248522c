#include "python/native/own_hand.hpp"

#include <cmath>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/text/numbers.hpp"
#include "python/native/fields.hpp"

namespace forcebound::python {
namespace {

constexpr double kSample_s = 1e-3;  // Operator: the device takes a sample each millisecond
constexpr const char* kPosition = "the position of a hand";

Vector finite_from(py::handle value, Eigen::Index rows, const char* name) {
  Vector vector = vector_from(value, rows, name);
  if (!vector.allFinite()) throw py::value_error(std::string(name) + " must be finite");
  return vector;
}

/// Position and velocity of what a function returned; the velocity is `none` where it gave a position alone.
std::pair<py::object, py::object> parts_of(const py::object& returned) {
  if (!py::isinstance<py::tuple>(returned)) return {returned, py::none()};
  const auto parts = py::reinterpret_borrow<py::tuple>(returned);
  if (parts.size() == 2) return {parts[0], parts[1]};
  throw py::value_error("a hand: expected position or (position, velocity), got a tuple of " +
                        std::to_string(parts.size()) + "; a position of several axes is a list or an array");
}

double not_negative(py::handle hand, const char* name) {
  const double value = number_from(hand.attr(name), name);
  if (value >= 0 && std::isfinite(value)) return value;
  throw py::value_error(std::string("OwnHand: ") + name + " must be finite and >= 0, got " + text::to_text(value));
}

}  // namespace

device::Operator::Target OwnHand::asked(double time_s) const {
  const auto [position, velocity] = parts_of(shared_->target(time_s));
  Target target{.position = finite_from(position, dof_, kPosition), .velocity = Vector::Zero(dof_)};
  if (velocity.is_none()) {
    const py::object later = parts_of(shared_->target(time_s + kSample_s)).first;
    target.velocity = (finite_from(later, dof_, kPosition) - target.position) / kSample_s;
  } else {
    target.velocity = finite_from(velocity, dof_, "the velocity of a hand");
  }
  return target;
}

device::Operator::Target OwnHand::target(double time_s) const noexcept {
  const py::gil_scoped_acquire gil;
  if (!shared_->fault.kept()) {
    try {
      return last_ = asked(time_s);
    } catch (...) {
      shared_->fault.keep(std::current_exception());
      last_.velocity.setZero();
      last_.grip = 0;
    }
  }
  return last_;
}

std::string OwnHand::description() const {
  control::ClassicText text;
  text << "own:mass_kg=" << hand().mass_kg << ",stiffness_N_per_m=" << hand().stiffness_N_per_m
       << ",damping_N_s_per_m=" << hand().damping_N_s_per_m << " (a function in Python)";
  return text.str();
}

std::shared_ptr<OwnHand::Shared> own_hand_from(py::handle hand) {
  auto shared = std::make_shared<OwnHand::Shared>();
  shared->target = hand.attr("target");
  shared->hand = {.mass_kg = not_negative(hand, "mass_kg"),
                  .stiffness_N_per_m = not_negative(hand, "stiffness_N_per_m"),
                  .damping_N_s_per_m = not_negative(hand, "damping_N_s_per_m")};
  return shared;
}

}  // namespace forcebound::python
