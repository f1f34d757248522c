#include "python/native/fields.hpp"

namespace forcebound::python {

std::string text_from(py::handle value, const char* name) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  throw py::type_error(std::string(name) + ": expected text, got " + py::str(py::type::of(value)).cast<std::string>());
}

double number_from(py::handle value, const char* name) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + ": expected a number, got " +
                         py::str(py::type::of(value)).cast<std::string>());
  }
  return number;
}

double seconds_from(py::handle value, const char* name) {
  constexpr double kMost_s = 1e6;
  const double seconds = number_from(value, name);
  if (seconds >= 0 && seconds <= kMost_s) return seconds;
  throw py::value_error(std::string(name) + " must be 0 to 1e6 s, got " + py::str(value).cast<std::string>());
}

long long whole_from(py::handle value, const char* name, long long least, long long most) {
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + ": expected a whole number, got " +
                         py::str(py::type::of(value)).cast<std::string>());
  }
  int beyond = 0;
  const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &beyond);
  if (beyond == 0 && number >= least && number <= most) return number;
  throw py::value_error(std::string(name) + " must be " + std::to_string(least) + " to " + std::to_string(most) +
                        ", got " + py::str(index).cast<std::string>());
}

}  // namespace forcebound::python
