#include "forcebound/record/recorder.hpp"

#include <boost/lockfree/spsc_queue.hpp>
#include <variant>

namespace forcebound::record {
namespace {

using Item = std::variant<TickRecord, ForceRecord, MotionRecord, SentForceRecord>;

}  // namespace

struct Recorder::Queue {
  explicit Queue(std::size_t capacity) : items(capacity) {
    // Touched here, not in the tick: the first use of a page costs a fault.
    while (items.push(Item())) {
    }
    items.consume_all([](const Item&) {});
  }
  boost::lockfree::spsc_queue<Item> items;
};

Recorder::Recorder(std::size_t capacity) : queue_(std::make_unique<Queue>(capacity)) {}
Recorder::~Recorder() = default;

// A variant of plain values is copied with all its bytes, also those that its alternative has not; g++ 12 takes that
// for the use of a value that is missing.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
template <class Record>
void Recorder::push(const Record& record) noexcept {
  if (!queue_->items.push(Item(record))) dropped_.fetch_add(1, std::memory_order_relaxed);
}
#pragma GCC diagnostic pop

void Recorder::on_tick(const TickRecord& tick) noexcept { push(tick); }
void Recorder::on_force(const ForceRecord& force) noexcept { push(force); }
void Recorder::on_motion(const MotionRecord& motion) noexcept { push(motion); }
void Recorder::on_sent(const SentForceRecord& force) noexcept { push(force); }

std::size_t Recorder::drain(TopicEncoder& encoder) {
  const auto write = [&encoder](const Item& item) {
    std::visit([&encoder](const auto& record) { encoder.write(record); }, item);
  };
  std::size_t written = 0;
  while (queue_->items.consume_one(write)) ++written;  // one by one, so that each makes room at once
  return written;
}

}  // namespace forcebound::record
