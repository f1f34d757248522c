#pragma once

#include <memory>

#include "forcebound/server/offer/environment.hpp"
#include "python/native/arrays.hpp"
#include "python/native/python_fault.hpp"

namespace forcebound::python {

/// An environment that is a Python function, for the simulated loop alone:
///
///     f(position (dof,) [m], time_s) -> force (dof,) [N], or (force, unit normal (dof,), depth [m]) in contact
///
/// After its first exception the force is zero. It may be destroyed without the GIL.
class OwnEnvironment final : public server::Environment {
 public:
  struct Shared {
    py::object function;
    PythonFault fault{};
  };
  explicit OwnEnvironment(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}

  [[nodiscard]] server::Answer respond(const server::Motion& motion) noexcept override;

 private:
  [[nodiscard]] server::Answer asked(const server::Motion& motion) const;

  std::shared_ptr<Shared> shared_;
};

[[nodiscard]] server::EnvironmentKind own_environment(const std::string& name,
                                                      const std::shared_ptr<OwnEnvironment::Shared>& shared);

}  // namespace forcebound::python
