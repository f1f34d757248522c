#include "python/native/live_client.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "forcebound/device/simulated/make_operator.hpp"

namespace forcebound::python {
namespace {

RowShape shape_of_device(const control::DeviceFacts& facts) {
  return {.dof = facts.translations(), .joints = facts.joints()};
}

}  // namespace

KeptTicks::KeptTicks(RowShape shape, std::size_t rows_max) : layout_(tick_columns(), shape), rows_max_(rows_max) {
  if (rows_max > bytes_.max_size() / layout_.row_bytes()) {
    throw std::length_error("ticks_kept must fit into memory, got " + std::to_string(rows_max));
  }
  bytes_.resize(rows_max * layout_.row_bytes());
}

void KeptTicks::on_tick(const record::TickRecord& tick) noexcept {
  const std::size_t row = kept_.load(std::memory_order_relaxed);
  if (row == rows_max_ || !layout_.fits(tick)) {
    not_kept_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  layout_.fill(bytes_.data() + row * layout_.row_bytes(), tick);
  kept_.store(row + 1, std::memory_order_release);
}

py::array KeptTicks::since(std::size_t first) const {
  const std::size_t end = kept();
  const auto at = [this](std::size_t row) {
    return bytes_.begin() + static_cast<std::ptrdiff_t>(row * layout_.row_bytes());
  };
  return array_of_rows({at(std::min(first, end)), at(end)}, layout_.dtype());
}

LiveClient::LiveClient(const Settings& settings)
    : device_(settings.device, device::make_operator(settings.client.hand, settings.device.facts)),
      ticks_(shape_of_device(device_.facts()), settings.ticks_kept),
      client_({settings.client, settings.law_options}, device_, {&ticks_},
              {.problem = [this](const std::string& problem) { keep(problem); }}) {}

void LiveClient::keep(const std::string& problem) {
  const std::scoped_lock lock(mutex_);
  problems_.push_back(problem);
}

std::vector<std::string> LiveClient::problems() const {
  const std::scoped_lock lock(mutex_);
  return problems_;
}

}  // namespace forcebound::python
