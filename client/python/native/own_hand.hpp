#pragma once

#include <memory>

#include "forcebound/device/simulated/operator.hpp"
#include "python/native/arrays.hpp"
#include "python/native/python_fault.hpp"

namespace forcebound::python {

/// A hand whose target is a Python function (forcebound.simulation.OwnHand), for the simulated loop alone:
///
///     f(time_s) -> position (dof,) [m], or (position, velocity (dof,) [m/s])
///
/// A position alone moves in a straight line to the one a millisecond later. After the first exception the hand lets go
/// where it was. It may be destroyed without the GIL.
class OwnHand final : public device::Operator {
 public:
  struct Shared {
    py::object target;
    device::Hand hand{};
    PythonFault fault{};
  };
  OwnHand(std::shared_ptr<Shared> shared, int dof) : shared_(std::move(shared)), dof_(dof), last_{at_rest()} {}

  [[nodiscard]] std::string_view name() const noexcept override { return "own"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return shared_->hand; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return dof_; }
  [[nodiscard]] Target target(double time_s) const noexcept override;
  [[nodiscard]] std::string description() const override;

 private:
  [[nodiscard]] Target at_rest() const noexcept { return {Vector::Zero(dof_), Vector::Zero(dof_)}; }
  [[nodiscard]] Target asked(double time_s) const;

  std::shared_ptr<Shared> shared_;
  int dof_;
  mutable Target last_;
};

/// What forcebound.simulation.OwnHand holds. @throws py::value_error naming what must not be negative
[[nodiscard]] std::shared_ptr<OwnHand::Shared> own_hand_from(py::handle hand);

}  // namespace forcebound::python
