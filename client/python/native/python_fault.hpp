#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <utility>

namespace forcebound::python {

/// The first exception of Python code that was called from where none may be thrown: the simulation goes on with zero
/// force, and whoever started it throws it again. For one thread.
class PythonFault {
 public:
  void keep(std::exception_ptr error) noexcept {
    if (!error_) error_ = std::move(error);
  }
  [[nodiscard]] bool kept() const noexcept { return error_ != nullptr; }

  /// With the GIL held.
  void rethrow() {
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  std::exception_ptr error_;
};

}  // namespace forcebound::python
