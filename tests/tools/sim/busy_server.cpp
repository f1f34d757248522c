#include "tests/tools/sim/busy_server.hpp"

namespace forcebound::sim {

void BusyServer::arrive(std::span<const std::byte> datagram, const Address& from, Nanoseconds now) {
  Datagram came{{datagram.begin(), datagram.end()}, from, now};
  if (!in_turn_.empty()) {
    waiting_.push_back(std::move(came));
    return;
  }
  in_turn_.push_back(std::move(came));
  turn_ends_ = now + turn_;
}

std::optional<Nanoseconds> BusyServer::next_event() const noexcept {
  if (in_turn_.empty()) return std::nullopt;
  return turn_ends_;
}

void BusyServer::end_turn(
    const std::function<void(std::span<const std::byte>, const Address&, Nanoseconds arrival)>& receive) {
  for (const Datagram& datagram : in_turn_) receive(datagram.bytes, datagram.from, datagram.arrival);
  in_turn_ = std::move(waiting_);
  waiting_.clear();
  turn_ends_ += turn_;
}

void BusyServer::forget() noexcept {
  in_turn_.clear();
  waiting_.clear();
}

}  // namespace forcebound::sim
