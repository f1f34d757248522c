#include "tests/tools/netem/packet_queue.hpp"

#include <algorithm>

namespace forcebound::netem {

std::size_t PacketBuffers::store(std::span<const std::byte> bytes) {
  if (free_.empty()) {
    buffers_.emplace_back();
    free_.reserve(buffers_.capacity());  // so that release never allocates
    free_.push_back(buffers_.size() - 1);
  }
  const std::size_t buffer = free_.back();
  free_.pop_back();
  buffers_[buffer].assign(bytes.begin(), bytes.end());
  return buffer;
}

void PacketQueue::push(const WaitingPacket& packet, std::int64_t turn) {
  heap_.push_back({packet.departure, turn, packet});
  std::push_heap(heap_.begin(), heap_.end(), later);
}

WaitingPacket PacketQueue::pop() {
  std::pop_heap(heap_.begin(), heap_.end(), later);
  const WaitingPacket packet = heap_.back().packet;
  heap_.pop_back();
  return packet;
}

}  // namespace forcebound::netem
