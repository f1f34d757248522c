#pragma once

#include <memory>
#include <string>

#include "forcebound/control/law_registry.hpp"
#include "python/native/arrays.hpp"
#include "python/native/python_fault.hpp"

namespace forcebound::python {

/// A motion as a law in Python is told it, and may keep it.
struct MotionOfPython {
  control::Motion motion;
  Matrix damping;  ///< which the motion only points to
};

/// A law that is a Python object (forcebound.laws.OwnLaw), for the simulated loop alone: Python has no place in a tick
/// of real time. After the first exception its force is zero.
///
/// It may be destroyed without the GIL: `object` belongs to whoever made it.
class OwnLaw final : public control::PassivityLaw {
 public:
  struct Shared {
    py::object object;
    std::string name;
    PythonFault fault{};
  };
  explicit OwnLaw(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return shared_->name; }
  void credit(const control::Motion& motion) noexcept override { pass("credit", motion); }
  void lose(const control::Motion& motion) noexcept override { pass("lose", motion); }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override;
  void commit(const Vector& force_N) noexcept override;
  [[nodiscard]] double energy_J() const noexcept override { return number("energy_J", 0); }
  [[nodiscard]] double xi() const noexcept override { return number("xi", 1); }

 private:
  void pass(const char* what, const control::Motion& motion) noexcept;
  [[nodiscard]] double number(const char* attribute, double otherwise) const noexcept;

  std::shared_ptr<Shared> shared_;
};

/// Adds it to the laws of a run, by its name. @throws std::invalid_argument if there is one of that name
void add_own_law(control::LawRegistry& laws, const std::shared_ptr<OwnLaw::Shared>& shared);

}  // namespace forcebound::python
