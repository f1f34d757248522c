#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "forcebound/control/vector.hpp"

/// Records as rows of numpy's structured arrays.
namespace forcebound::python {

namespace py = pybind11;
using control::Vector;

/// How many numbers the vectors of a device have.
struct RowShape {
  int dof = 1;
  int joints = 1;
};

enum class Length : std::uint8_t { dof, joints, orientation };

/// One column: its name and how a record's value is found.
template <class Record>
struct Column {
  const char* name = nullptr;
  double (*number)(const Record&) = nullptr;
  std::uint64_t (*count)(const Record&) = nullptr;
  std::uint8_t (*code)(const Record&) = nullptr;  ///< of an enumeration
  bool (*flag)(const Record&) = nullptr;
  Vector (*vector)(const Record&) = nullptr;  ///< no rows: nan in all of them
  Length length = Length::dof;                ///< of the vector
};

/// Where the columns lie in a row, and how a record is written there. `fill` is real time: noexcept, no allocation, no
/// Python; `dtype` needs the GIL.
template <class Record>
class RowsOf {
 public:
  RowsOf(std::vector<Column<Record>> columns, RowShape shape) : columns_(std::move(columns)), shape_(shape) {
    for (const Column<Record>& column : columns_) {
      const std::size_t bytes = column.code != nullptr || column.flag != nullptr ? 1 : sizeof(double);
      row_bytes_ = (row_bytes_ + bytes - 1) / bytes * bytes;
      offsets_.push_back(row_bytes_);
      row_bytes_ += bytes * static_cast<std::size_t>(column.vector != nullptr ? rows_of(column) : 1);
    }
    row_bytes_ = (row_bytes_ + sizeof(double) - 1) / sizeof(double) * sizeof(double);
  }

  [[nodiscard]] std::size_t row_bytes() const noexcept { return row_bytes_; }

  /// Whether each vector of the record has as many rows as its column, or none.
  [[nodiscard]] bool fits(const Record& record) const noexcept {
    for (const Column<Record>& column : columns_) {
      if (column.vector == nullptr) continue;
      const auto rows = column.vector(record).rows();
      if (rows != 0 && rows != rows_of(column)) return false;
    }
    return true;
  }

  /// @param row of `row_bytes`, zero so far @param record that fits
  void fill(std::byte* row, const Record& record) const noexcept {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Column<Record>& column = columns_[i];
      std::byte* at = row + offsets_[i];
      if (column.number != nullptr) put(at, column.number(record));
      if (column.count != nullptr) put(at, column.count(record));
      if (column.code != nullptr) put(at, column.code(record));
      if (column.flag != nullptr) put(at, std::uint8_t{column.flag(record)});
      if (column.vector == nullptr) continue;
      const Vector vector = column.vector(record);
      for (Eigen::Index k = 0; k < rows_of(column); ++k) {
        const double number = vector.rows() == 0 ? std::numeric_limits<double>::quiet_NaN() : vector[k];
        put(at + static_cast<std::size_t>(k) * sizeof(double), number);
      }
    }
  }

  [[nodiscard]] py::dtype dtype() const {
    py::list names;
    py::list formats;
    py::list offsets;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Column<Record>& column = columns_[i];
      names.append(column.name);
      offsets.append(offsets_[i]);
      if (column.vector != nullptr) {
        formats.append(py::make_tuple("f8", py::make_tuple(rows_of(column))));
      } else {
        formats.append(column.number != nullptr  ? "f8"
                       : column.count != nullptr ? "u8"
                       : column.code != nullptr  ? "u1"
                                                 : "?");
      }
    }
    return {names, formats, offsets, static_cast<py::ssize_t>(row_bytes_)};
  }

 private:
  template <class Value>
  static void put(std::byte* at, Value value) noexcept {
    std::memcpy(at, &value, sizeof value);
  }

  [[nodiscard]] Eigen::Index rows_of(const Column<Record>& column) const noexcept {
    constexpr Eigen::Index kQuaternion = 4;
    if (column.length == Length::orientation) return kQuaternion;
    return column.length == Length::joints ? shape_.joints : shape_.dof;
  }

  std::vector<Column<Record>> columns_;
  std::vector<std::size_t> offsets_;
  RowShape shape_;
  std::size_t row_bytes_ = 0;
};

/// `bytes` as an array of that dtype, without a copy.
[[nodiscard]] py::array array_of_rows(std::vector<std::byte> bytes, const py::dtype& dtype);

}  // namespace forcebound::python
