#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace forcebound::results {

/// Thins curves over a common x, of any length, to at most 2000 columns with nothing that stands out lost: each column
/// keeps every curve's lowest and highest value, and a curve with a gap in the column is interrupted at its end. Within
/// a column the values before and after a gap are joined.
///
/// `add` allocates nothing, so it may be fed from a sink.
class Envelope {
 public:
  /// Of x one value, and of each curve; NaN where it is interrupted.
  struct Point {
    double x;
    std::vector<double> y;
  };

  explicit Envelope(std::size_t curves);

  /// @param x finite; must not decrease
  /// @param y one value for each curve; what is not finite interrupts it
  void add(double x, std::span<const double> y) noexcept;

  /// At most three for each column.
  [[nodiscard]] std::vector<Point> points() const;

 private:
  static constexpr std::size_t kColumns = 2000;

  struct Column {
    double begin;
    double end;
  };
  /// A curve in a column.
  struct Extent {
    double low;  ///< NaN: interrupted throughout
    double high;
    bool low_first;
    bool gap;  ///< interrupted somewhere
  };

  void halve() noexcept;
  [[nodiscard]] static Extent merged(const Extent& first, const Extent& second) noexcept;
  [[nodiscard]] std::span<const Extent> extents_of(std::size_t column) const noexcept {
    return std::span(extents_).subspan(column * curves_, curves_);
  }

  std::size_t curves_;
  std::vector<Column> columns_;
  std::vector<Extent> extents_;  ///< column by column
  std::size_t per_column_ = 1;
  std::size_t in_last_ = 0;
};

}  // namespace forcebound::results
