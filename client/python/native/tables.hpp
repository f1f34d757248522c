#pragma once

#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/tick_record.hpp"
#include "python/native/rows_of.hpp"

namespace forcebound::python {

/// What a row of each table has; the same columns in recordings, in the simulated loop and at a live client.
[[nodiscard]] std::vector<Column<record::TickRecord>> tick_columns();
[[nodiscard]] std::vector<Column<record::ForceRecord>> force_columns();
[[nodiscard]] std::vector<Column<record::MotionRecord>> motion_columns();
[[nodiscard]] std::vector<Column<record::SentForceRecord>> sent_columns();

[[nodiscard]] RowShape shape_of(const record::TickRecord& tick) noexcept;
[[nodiscard]] RowShape shape_of(const record::ForceRecord& force) noexcept;
[[nodiscard]] RowShape shape_of(const record::MotionRecord& motion) noexcept;
[[nodiscard]] RowShape shape_of(const record::SentForceRecord& force) noexcept;

/// A table that grows, with the shape of its first record. Makes no use of Python before `take`.
template <class Record>
class Table {
 public:
  explicit Table(std::vector<Column<Record>> columns) : columns_(std::move(columns)) {}

  /// @throws std::invalid_argument for a record whose vectors have other lengths than the first one's
  void add(const Record& record);

  [[nodiscard]] std::size_t size() const noexcept { return rows_; }

  /// All rows since the last time.
  [[nodiscard]] py::array take();

 private:
  std::vector<Column<Record>> columns_;
  std::optional<RowsOf<Record>> layout_;
  std::vector<std::byte> bytes_;
  std::size_t rows_ = 0;
};

/// The ticks and forces of a loop that is simulated or was recorded.
class LoopTables final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override { add(ticks_, tick); }
  void on_force(const record::ForceRecord& force) noexcept override { add(forces_, force); }

  [[nodiscard]] bool has_ticks() const noexcept { return ticks_.size() > 0; }

  /// @throws what went wrong in `on_tick` or `on_force`: std::invalid_argument for one that does not fit those before
  void rethrow() {
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }
  [[nodiscard]] py::array take_ticks() { return ticks_.take(); }
  [[nodiscard]] py::array take_forces() { return forces_.take(); }

 private:
  template <class Record>
  void add(Table<Record>& table, const Record& record) noexcept {
    try {
      if (!error_) table.add(record);
    } catch (...) {
      error_ = std::current_exception();
    }
  }

  Table<record::TickRecord> ticks_{tick_columns()};
  Table<record::ForceRecord> forces_{force_columns()};
  std::exception_ptr error_;
};

}  // namespace forcebound::python
