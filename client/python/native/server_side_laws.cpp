#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/server_side_law.hpp"
#include "python/native/arrays.hpp"
#include "python/native/bindings.hpp"
#include "python/native/running_law.hpp"

namespace forcebound::python {
namespace {

/// The part of a law that runs at the server, with its device's number of axes.
class ServerSide {
 public:
  ServerSide(const std::string& law, int degrees_of_freedom) : rows_(degrees_of_freedom) {
    if (rows_ < 1 || rows_ > control::kDofMax) {
      throw std::invalid_argument("degrees of freedom must be 1 to 6, got " + std::to_string(rows_));
    }
    law_ = baselines::shipped_laws().make_server_side(law, rows_);
    if (!law_) throw std::invalid_argument("law '" + law + "' has no server-side law");
  }

  py::array_t<double> place(py::handle position, py::handle numbers, double interval_s) {
    const Vector at = vector_from(position, rows_, "position");
    const control::ServerLawNumbers received = server_law_numbers_from(numbers);
    if (!at.allFinite() || !received.allFinite() || !(interval_s >= 0) || !std::isfinite(interval_s)) {
      throw py::value_error("position, numbers and interval_s must be finite, and the interval >= 0 s");
    }
    return array_of(law_->place({at, received, interval_s}));
  }

  py::tuple answer(py::handle force_N) {
    const Vector force = vector_from(force_N, rows_, "force_N");
    if (!force.allFinite()) throw py::value_error("force_N must be finite");
    const control::ServerSideLaw::Reply reply = law_->answer(force);
    return py::make_tuple(array_of(reply.force), array_of(reply.numbers.data(), reply.numbers.rows()));
  }

 private:
  std::unique_ptr<control::ServerSideLaw> law_;
  int rows_;
};

}  // namespace

control::ServerLawNumbers server_law_numbers_from(py::handle numbers) {
  const Rows rows(numbers, {}, "numbers");
  if (rows.size() > control::ServerLawNumbers::MaxRowsAtCompileTime) {
    throw py::value_error("numbers: expected at most " +
                          std::to_string(control::ServerLawNumbers::MaxRowsAtCompileTime) + ", got " +
                          std::to_string(rows.size()));
  }
  control::ServerLawNumbers into(rows.size());
  for (py::ssize_t i = 0; i < rows.size(); ++i) into[i] = rows.read(i);
  return into;
}

void bind_server_side_laws(py::module_& module) {
  py::class_<ServerSide>(module, "ServerSideLaw", "The part of a law that runs at the server.")
      .def(py::init<const std::string&, int>(), py::arg("law"), py::arg("degrees_of_freedom"))
      .def("place", &ServerSide::place, py::arg("position"), py::arg("numbers"), py::arg("interval_s"),
           "position (dof,) [m] of the device, numbers from its law -> where the environment is asked (dof,) [m].")
      .def("answer", &ServerSide::answer, py::arg("force_N"),
           "force_N (dof,) of the environment there -> force (dof,) [N] and numbers for the law at the device.");
}

}  // namespace forcebound::python
