#include "python/native/own_environment.hpp"

namespace forcebound::python {

server::Answer OwnEnvironment::asked(const server::Motion& motion) const {
  const Eigen::Index rows = motion.position.rows();
  const py::object returned = shared_->function(array_of(motion.position), time::to_seconds(motion.server_time));
  if (!py::isinstance<py::tuple>(returned))
    return {.force = vector_from(returned, rows, "the force of an environment")};
  const auto parts = py::reinterpret_borrow<py::tuple>(returned);
  if (parts.size() != 3) {
    throw py::value_error("an environment: expected force or (force, normal, depth), got a tuple of " +
                          std::to_string(parts.size()));
  }
  const py::object force = parts[0];
  const py::object normal = parts[1];
  server::Answer answer{.force = vector_from(force, rows, "the force of an environment")};
  const double depth_m = py::object(parts[2]).cast<double>();
  if (depth_m > 0) {
    answer.contact_normal = vector_from(normal, rows, "the normal of an environment");
    answer.penetration_m = depth_m;
  }
  return answer;
}

server::Answer OwnEnvironment::respond(const server::Motion& motion) noexcept {
  const py::gil_scoped_acquire gil;
  if (!shared_->fault.kept()) {
    try {
      return asked(motion);
    } catch (...) {
      shared_->fault.keep(std::current_exception());
    }
  }
  return {.force = Vector::Zero(motion.position.rows())};
}

server::EnvironmentKind own_environment(const std::string& name,
                                        const std::shared_ptr<OwnEnvironment::Shared>& shared) {
  return {.name = name, .make = [shared](const server::ClientFacts&) {
            return server::MadeEnvironment{std::make_unique<OwnEnvironment>(shared), "a function in Python"};
          }};
}

}  // namespace forcebound::python
