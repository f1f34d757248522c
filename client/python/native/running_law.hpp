#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "forcebound/baselines/running_law.hpp"
#include "python/native/arrays.hpp"

namespace forcebound::python {

/// What law and server-side law tell each other: (k,), k <= 16. @throws py::value_error
[[nodiscard]] control::ServerLawNumbers server_law_numbers_from(py::handle numbers);

/// baselines::RunningLaw, ticked from Python.
///
/// A law has one owner: what is called while a sequence runs in another thread throws std::runtime_error.
class RunningLaw {
 public:
  /// @throws std::invalid_argument as LawRegistry::make and ForceBounder
  RunningLaw(control::DeviceFacts facts, const std::string& name, control::LawOptions options);

  /// What a tick may be told beside position and request; None: by the facts.
  struct Tick {
    py::object interval_s;
    py::object joint;
    py::object jacobian;
    py::object latency_s;
    py::object latency_s_max;
    py::object effect_s;
    py::object held_s;
    bool write_failed = false;
  };
  /// One tick: the force for the device (dof,) [N]. @param request_N None: no answer of the environment
  py::array_t<double> step(py::handle position, py::handle request_N, const Tick& tick);

  struct Recorded {
    py::object intervals_s;
    py::object joints;
    py::object jacobians;
    py::object latencies_s;
  };
  /// Many ticks: force_N (n, dof), energy_J (n,), xi (n,) after each. Other Python threads run meanwhile.
  py::tuple run(py::handle positions, py::handle requests_N, const Recorded& recorded);

  /// The force, or zero where it takes effect too late.
  py::array_t<double> confirm(py::handle force_N, double latency_s);

  void receive(py::handle numbers);
  [[nodiscard]] py::array_t<double> outgoing() const;
  void begin_server_side();

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept { return law_.facts(); }
  [[nodiscard]] const control::LawOptions& options() const noexcept { return law_.options(); }
  [[nodiscard]] double energy_J() const;
  [[nodiscard]] double xi() const;
  [[nodiscard]] py::dict counts() const;

 private:
  class InUse;
  class Sequence;

  void read_joints(py::handle position, const Tick& tick);

  baselines::RunningLaw law_;
  Vector request_N_;
  mutable std::atomic<bool> in_use_{false};
};

}  // namespace forcebound::python
