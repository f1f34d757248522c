#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "forcebound/control/vector.hpp"

/// Numbers from Python and back. Whatever is not of float64 is converted where float64 holds it (integers, float32);
/// arrays of float64 are read where they lie, whatever their strides.
namespace forcebound::python {

namespace py = pybind11;
using control::Matrix;
using control::Vector;

/// "(3,)", "(n, 3)" with -1 for a length that may be any.
[[nodiscard]] std::string shape_in_words(const std::vector<py::ssize_t>& shape);

/// @throws py::type_error naming the dtype if it is not one of numbers that float64 holds; what numpy throws for ragged
/// lists
[[nodiscard]] py::array doubles_from(py::handle value, const char* name);

/// A vector of `rows` numbers; a plain number is one of a single row.
/// @throws py::value_error naming both shapes, and as doubles_from
[[nodiscard]] Vector vector_from(py::handle value, Eigen::Index rows, const char* name);

/// Likewise, of 1 to 6 rows.
[[nodiscard]] Vector any_vector_from(py::handle value, const char* name);

/// A number for all rows, or one for each.
[[nodiscard]] Vector per_row_from(py::handle value, Eigen::Index rows, const char* name);

[[nodiscard]] Matrix matrix_from(py::handle value, Eigen::Index rows, Eigen::Index columns, const char* name);

[[nodiscard]] py::array_t<double> array_of(const double* numbers, Eigen::Index count);
[[nodiscard]] py::array_t<double> array_of(const Vector& vector);
[[nodiscard]] py::array_t<double> array_of(const Matrix& matrix);

/// As above, and nobody can write to it: for properties, of which a change would be lost.
template <class Numbers>
[[nodiscard]] py::array_t<double> read_only(const Numbers& numbers) {
  py::array_t<double> array = array_of(numbers);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// A recorded sequence: n rows of `columns` numbers, or of `columns[0]` x `columns[1]`.
class Rows {
 public:
  /// @throws py::value_error naming both shapes, and as doubles_from
  Rows(py::handle value, std::vector<py::ssize_t> columns, const char* name);

  [[nodiscard]] py::ssize_t size() const noexcept { return array_.shape(0); }

  void read(py::ssize_t row, Vector& into) const noexcept {
    const char* at = begin_ + row * strides_[0];
    for (Eigen::Index i = 0; i < into.rows(); ++i) into[i] = number(at + i * strides_[1]);
  }
  void read(py::ssize_t row, Matrix& into) const noexcept {
    const char* at = begin_ + row * strides_[0];
    for (Eigen::Index i = 0; i < into.rows(); ++i) {
      for (Eigen::Index j = 0; j < into.cols(); ++j) into(i, j) = number(at + i * strides_[1] + j * strides_[2]);
    }
  }
  [[nodiscard]] double read(py::ssize_t row) const noexcept { return number(begin_ + row * strides_[0]); }

 private:
  static double number(const char* at) noexcept {
    double value = 0;
    std::memcpy(&value, at, sizeof value);
    return value;
  }

  py::array array_;
  const char* begin_ = nullptr;
  std::array<py::ssize_t, 3> strides_{};
};

/// @throws py::value_error naming both counts unless `rows` has as many as the positions
void expect_as_many(const Rows& rows, py::ssize_t count, const char* name);

}  // namespace forcebound::python
