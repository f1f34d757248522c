#include "forcebound/client/page/tick_tap.hpp"

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>

namespace forcebound::client {
namespace {

Axes axes_of(const control::Vector& vector) noexcept {
  Axes axes{};
  const auto rows = std::min<Eigen::Index>(vector.rows(), static_cast<Eigen::Index>(axes.size()));
  for (Eigen::Index i = 0; i < rows; ++i) axes[static_cast<std::size_t>(i)] = static_cast<float>(vector[i]);
  return axes;
}

/// Touched here, not in the tick: the first use of a page of memory costs a fault.
template <class Item>
void touch(boost::lockfree::spsc_queue<Item>& queue) {
  while (queue.push(Item{})) {
  }
  queue.consume_all([](const Item&) {});
}

}  // namespace

struct TickTap::Queues {
  explicit Queues(std::size_t capacity) : ticks(capacity), forces(capacity) {
    touch(ticks);
    touch(forces);
  }
  boost::lockfree::spsc_queue<TickSample> ticks;
  boost::lockfree::spsc_queue<ForceSample> forces;
};

TickTap::TickTap(std::size_t capacity) : queues_(std::make_unique<Queues>(capacity)) {}
TickTap::~TickTap() = default;

void TickTap::on_tick(const record::TickRecord& tick) noexcept {
  touches_.store(tick.contact, std::memory_order_relaxed);
  records_.on_tick(tick);
  if (!queues_->ticks.push(sampler_.sample(tick))) dropped_.fetch_add(1, std::memory_order_relaxed);
}

void TickTap::on_force(const record::ForceRecord& record) noexcept {
  records_.on_force(record);
  if (!queues_->forces.push(sampler_.sample(record))) dropped_.fetch_add(1, std::memory_order_relaxed);
}

TickSample Sampler::sample(const record::TickRecord& tick) const noexcept {
  const bool own_place = tick.rendering == record::ForceOrigin::at_client;
  return {.time = tick.time,
          .interval = tick.interval,
          .latency = tick.latency,
          .age = tick.force_age,
          .motion_sequence = tick.motion_sequence,
          .force_sequence = tick.force_sequence,
          .position_m = axes_of(tick.position),
          .place_m = own_place ? axes_of(tick.position) : place_m_,
          .asked_N = axes_of(tick.request),
          .applied_N = axes_of(tick.applied),
          .applied_torque_N_m = axes_of(tick.applied_torque_N_m),
          .orientation = tick.handle.orientation.value_or(TickSample{}.orientation),
          .ledger_J = tick.energy_J,
          .audit_J = tick.audit_J,
          .audit_minimum_J = tick.audit_minimum_J,
          .state = tick.state,
          .contact = tick.contact,
          .has_place = own_place || has_place_,
          .has_orientation = tick.handle.orientation.has_value(),
          .usable = tick.position.allFinite()};
}

ForceSample Sampler::sample(const record::ForceRecord& record) noexcept {
  const wire::EnvironmentForce& force = record.force;
  const wire::Answer& answer = force.answer;
  place_m_ = axes_of(force.position);
  has_place_ = true;
  ForceSample sample{.session = force.session,
                     .sequence = force.sequence,
                     .motion_sequence = force.motion_sequence,
                     .motions_received = force.motions_received,
                     .received = record.receive_time,
                     .round_trip = record.round_trip,
                     .at_server = force.server_send_time - force.server_receive_time,
                     .follower = answer.follower};
  if (answer.contact_normal.rows() > 0 && answer.contact_normal.rows() == force.position.rows()) {
    sample.contact = true;
    sample.normal = axes_of(answer.contact_normal);
    const control::Vector surface_m = force.position + answer.penetration_m * answer.contact_normal;
    sample.surface_m = axes_of(surface_m);
  }
  return sample;
}

void TickTap::drain(const std::function<void(const ForceSample&)>& forces,
                    const std::function<void(const TickSample&)>& ticks) {
  queues_->forces.consume_all(forces);
  queues_->ticks.consume_all(ticks);
}

}  // namespace forcebound::client
