#include "python/native/arrays.hpp"

#include <algorithm>

namespace forcebound::python {
namespace {

using Shape = std::vector<py::ssize_t>;

Shape shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

[[noreturn]] void refuse_shape(const char* name, const std::string& expected, const py::array& got) {
  throw py::value_error(std::string(name) + ": expected shape " + expected + ", got " + shape_in_words(shape_of(got)));
}

bool holds_doubles(const py::array& array) { return py::isinstance<py::array_t<double, 0>>(array); }

}  // namespace

std::string shape_in_words(const Shape& shape) {
  std::string words = "(";
  for (const py::ssize_t length : shape) {
    words += (words.size() > 1 ? ", " : "") + (length < 0 ? std::string("n") : std::to_string(length));
  }
  return words + (shape.size() == 1 ? ",)" : ")");
}

py::array doubles_from(py::handle value, const char* name) {
  if (py::isinstance<py::array>(value)) {
    auto array = py::reinterpret_borrow<py::array>(value);
    if (holds_doubles(array)) return array;
  }
  if (value.is_none()) throw py::type_error(std::string(name) + ": expected numbers, got None");
  const py::array any(py::reinterpret_borrow<py::object>(value));
  const char kind = any.dtype().kind();
  const bool fits = kind == 'i' || kind == 'u' || (kind == 'f' && any.itemsize() <= py::ssize_t{sizeof(double)});
  if (!fits) {
    throw py::type_error(std::string(name) + ": expected numbers that float64 holds, got dtype " +
                         py::str(any.dtype()).cast<std::string>());
  }
  return py::array_t<double, py::array::c_style | py::array::forcecast>(any);
}

Vector vector_from(py::handle value, Eigen::Index rows, const char* name) {
  const py::array array = doubles_from(value, name);
  const bool number = array.ndim() == 0 && rows == 1;
  if (!number && (array.ndim() != 1 || array.shape(0) != rows)) refuse_shape(name, shape_in_words({rows}), array);
  Vector vector(rows);
  const auto* at = static_cast<const char*>(array.data());
  const py::ssize_t stride = number ? 0 : array.strides(0);
  for (Eigen::Index i = 0; i < rows; ++i) std::memcpy(&vector[i], at + i * stride, sizeof(double));
  return vector;
}

Vector any_vector_from(py::handle value, const char* name) {
  const py::array array = doubles_from(value, name);
  if (array.ndim() > 1 || (array.ndim() == 1 && (array.shape(0) < 1 || array.shape(0) > control::kDofMax))) {
    refuse_shape(name, "(n,) of 1 to 6 numbers", array);
  }
  return vector_from(array, array.ndim() == 0 ? 1 : array.shape(0), name);
}

Vector per_row_from(py::handle value, Eigen::Index rows, const char* name) {
  const py::array array = doubles_from(value, name);
  if (array.ndim() == 0) return Vector::Constant(rows, vector_from(array, 1, name)[0]);
  return vector_from(array, rows, name);
}

Matrix matrix_from(py::handle value, Eigen::Index rows, Eigen::Index columns, const char* name) {
  const py::array array = doubles_from(value, name);
  if (array.ndim() != 2 || array.shape(0) != rows || array.shape(1) != columns) {
    refuse_shape(name, shape_in_words({rows, columns}), array);
  }
  Matrix matrix(rows, columns);
  const auto* at = static_cast<const char*>(array.data());
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      std::memcpy(&matrix(i, j), at + i * array.strides(0) + j * array.strides(1), sizeof(double));
    }
  }
  return matrix;
}

py::array_t<double> array_of(const double* numbers, Eigen::Index count) {
  py::array_t<double> array(count);
  std::copy_n(numbers, count, array.mutable_data());
  return array;
}

py::array_t<double> array_of(const Vector& vector) { return array_of(vector.data(), vector.rows()); }

py::array_t<double> array_of(const Matrix& matrix) {
  py::array_t<double> array({matrix.rows(), matrix.cols()});
  auto numbers = array.mutable_unchecked<2>();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) numbers(i, j) = matrix(i, j);
  }
  return array;
}

Rows::Rows(py::handle value, Shape columns, const char* name) : array_(doubles_from(value, name)) {
  columns.insert(columns.begin(), -1);
  Shape shape = shape_of(array_);
  if (!shape.empty()) shape.front() = -1;
  if (shape != columns) refuse_shape(name, shape_in_words(columns), array_);
  begin_ = static_cast<const char*>(array_.data());
  std::copy_n(array_.strides(), array_.ndim(), strides_.begin());
}

void expect_as_many(const Rows& rows, py::ssize_t count, const char* name) {
  if (rows.size() == count) return;
  throw py::value_error(std::string(name) + ": expected " + std::to_string(count) + " rows, as of positions, got " +
                        std::to_string(rows.size()));
}

}  // namespace forcebound::python
