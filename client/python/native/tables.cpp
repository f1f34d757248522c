#include "python/native/tables.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "forcebound/time/clock.hpp"

namespace forcebound::python {
namespace {

using record::ForceRecord;
using record::MotionRecord;
using record::SentForceRecord;
using record::TickRecord;
using time::to_seconds;

double number_of(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

Vector orientation_of(const control::Handle& handle) {
  if (!handle.orientation) return {};
  return Vector::Map(handle.orientation->data(), static_cast<Eigen::Index>(handle.orientation->size()));
}

int rows_in(const Vector& vector) noexcept { return std::max(1, static_cast<int>(vector.rows())); }

/// Of `force`, which a record of one or of the other end has.
template <class Record>
void add_force_columns(std::vector<Column<Record>>& columns) {
  columns.insert(
      columns.end(),
      {{.name = "sequence", .count = [](const Record& r) { return r.force.sequence; }},
       {.name = "motion_sequence", .count = [](const Record& r) { return r.force.motion_sequence; }},
       {.name = "motion_device_time_s",
        .number = [](const Record& r) { return to_seconds(r.force.motion_device_time); }},
       {.name = "force_N", .vector = [](const Record& r) { return r.force.answer.force; }},
       {.name = "position", .vector = [](const Record& r) { return r.force.position; }},
       {.name = "contact", .flag = [](const Record& r) { return r.force.answer.contact_normal.rows() > 0; }},
       {.name = "contact_normal", .vector = [](const Record& r) { return r.force.answer.contact_normal; }},
       {.name = "penetration_m", .number = [](const Record& r) { return r.force.answer.penetration_m; }},
       {.name = "server_receive_time_s",
        .number = [](const Record& r) { return to_seconds(r.force.server_receive_time); }},
       {.name = "server_send_time_s", .number = [](const Record& r) { return to_seconds(r.force.server_send_time); }},
       {.name = "compute_time_s", .number = [](const Record& r) { return to_seconds(r.force.compute_time); }},
       {.name = "server_parts_N", .vector = [](const Record& r) { return r.force.answer.server_parts_N; }}});
}

}  // namespace

std::vector<Column<TickRecord>> tick_columns() {
  using R = TickRecord;
  return {{.name = "tick", .count = [](const R& r) { return r.tick; }},
          {.name = "time_s", .number = [](const R& r) { return to_seconds(r.time); }},
          {.name = "interval_s", .number = [](const R& r) { return to_seconds(r.interval); }},
          {.name = "latency_s", .number = [](const R& r) { return to_seconds(r.latency); }},
          {.name = "state", .code = [](const R& r) { return static_cast<std::uint8_t>(r.state); }},
          {.name = "policy", .code = [](const R& r) { return static_cast<std::uint8_t>(r.policy); }},
          {.name = "rendering", .code = [](const R& r) { return static_cast<std::uint8_t>(r.rendering); }},
          {.name = "contact", .flag = [](const R& r) { return r.contact; }},
          {.name = "motion_sequence", .count = [](const R& r) { return r.motion_sequence; }},
          {.name = "force_sequence", .count = [](const R& r) { return r.force_sequence; }},
          {.name = "force_age_s", .number = [](const R& r) { return to_seconds(r.force_age); }},
          {.name = "position", .vector = [](const R& r) { return r.position; }},
          {.name = "joint", .vector = [](const R& r) { return r.joint; }, .length = Length::joints},
          {.name = "request_N", .vector = [](const R& r) { return r.request; }},
          {.name = "applied_N", .vector = [](const R& r) { return r.applied; }},
          {.name = "remote_N", .vector = [](const R& r) { return r.remote; }},
          {.name = "local_N", .vector = [](const R& r) { return r.local; }},
          {.name = "model_N", .vector = [](const R& r) { return r.model; }},
          {.name = "model_deviation_m", .number = [](const R& r) { return r.model_deviation_m; }},
          {.name = "model_trust", .number = [](const R& r) { return number_of(r.model_trust); }},
          {.name = "penetration_m", .number = [](const R& r) { return r.penetration_m; }},
          {.name = "displayed_N", .number = [](const R& r) { return r.displayed_N; }},
          {.name = "energy_J", .number = [](const R& r) { return r.energy_J; }},
          {.name = "xi", .number = [](const R& r) { return r.xi; }},
          {.name = "audit_J", .number = [](const R& r) { return r.audit_J; }},
          {.name = "audit_minimum_J", .number = [](const R& r) { return r.audit_minimum_J; }},
          {.name = "buttons", .count = [](const R& r) { return std::uint64_t{r.handle.buttons.value_or(0)}; }},
          {.name = "gripper", .number = [](const R& r) { return number_of(r.handle.gripper); }},
          {.name = "orientation",
           .vector = [](const R& r) { return orientation_of(r.handle); },
           .length = Length::orientation}};
}

std::vector<Column<ForceRecord>> force_columns() {
  using R = ForceRecord;
  std::vector<Column<R>> columns{
      {.name = "receive_time_s", .number = [](const R& r) { return to_seconds(r.receive_time); }},
      {.name = "round_trip_s", .number = [](const R& r) { return to_seconds(r.round_trip); }}};
  add_force_columns(columns);
  return columns;
}

std::vector<Column<SentForceRecord>> sent_columns() {
  std::vector<Column<SentForceRecord>> columns;
  add_force_columns(columns);
  return columns;
}

std::vector<Column<MotionRecord>> motion_columns() {
  using R = MotionRecord;
  return {{.name = "receive_time_s", .number = [](const R& r) { return to_seconds(r.receive_time); }},
          {.name = "session", .count = [](const R& r) { return r.motion.session; }},
          {.name = "sequence", .count = [](const R& r) { return r.motion.sequence; }},
          {.name = "device_time_s", .number = [](const R& r) { return to_seconds(r.motion.device_time); }},
          {.name = "position", .vector = [](const R& r) { return r.motion.position; }},
          {.name = "buttons", .count = [](const R& r) { return std::uint64_t{r.motion.handle.buttons.value_or(0)}; }},
          {.name = "gripper", .number = [](const R& r) { return number_of(r.motion.handle.gripper); }},
          {.name = "orientation",
           .vector = [](const R& r) { return orientation_of(r.motion.handle); },
           .length = Length::orientation}};
}

RowShape shape_of(const TickRecord& tick) noexcept {
  return {.dof = rows_in(tick.applied), .joints = rows_in(tick.joint)};
}
RowShape shape_of(const ForceRecord& force) noexcept { return {.dof = rows_in(force.force.answer.force)}; }
RowShape shape_of(const MotionRecord& motion) noexcept { return {.dof = rows_in(motion.motion.position)}; }
RowShape shape_of(const SentForceRecord& force) noexcept { return {.dof = rows_in(force.force.answer.force)}; }

py::array array_of_rows(std::vector<std::byte> bytes, const py::dtype& dtype) {
  auto owned = std::make_unique<std::vector<std::byte>>(std::move(bytes));
  const py::ssize_t rows = static_cast<py::ssize_t>(owned->size()) / dtype.itemsize();
  std::byte* const begin = owned->data();
  const py::capsule owner(owned.get(), [](void* vector) { delete static_cast<std::vector<std::byte>*>(vector); });
  (void)owned.release();
  return py::array(dtype, {rows}, {dtype.itemsize()}, begin, owner);
}

template <class Record>
void Table<Record>::add(const Record& record) {
  if (!layout_) layout_.emplace(columns_, shape_of(record));
  if (!layout_->fits(record)) {
    throw std::invalid_argument("record " + std::to_string(rows_ + 1) +
                                " has vectors of other lengths than the first one");
  }
  bytes_.resize(bytes_.size() + layout_->row_bytes());
  layout_->fill(bytes_.data() + bytes_.size() - layout_->row_bytes(), record);
  ++rows_;
}

template <class Record>
py::array Table<Record>::take() {
  const RowsOf<Record> layout = layout_ ? *layout_ : RowsOf<Record>(columns_, RowShape{});
  return array_of_rows(std::exchange(bytes_, {}), layout.dtype());
}

template class Table<TickRecord>;
template class Table<ForceRecord>;
template class Table<MotionRecord>;
template class Table<SentForceRecord>;

}  // namespace forcebound::python
