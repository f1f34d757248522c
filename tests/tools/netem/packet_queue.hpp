#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/tools/netem/verdict.hpp"

namespace forcebound::netem {

/// A packet on its way through an impairment.
struct WaitingPacket {
  Verdict verdict{};
  std::uint64_t tag = 0;
  std::size_t buffer = 0;  ///< in the PacketBuffers
  std::size_t bytes = 0;   ///< of payload
  Nanoseconds departure{0};
};

/// Buffers that are used again, so that steady running does not allocate.
class PacketBuffers {
 public:
  std::size_t store(std::span<const std::byte> bytes);
  void release(std::size_t buffer) { free_.push_back(buffer); }
  [[nodiscard]] std::span<std::byte> operator[](std::size_t buffer) noexcept { return buffers_[buffer]; }

 private:
  std::vector<std::vector<std::byte>> buffers_;
  std::vector<std::size_t> free_;
};

/// Packets by departure, and by turn where departures are the same. A lower turn is first.
class PacketQueue {
 public:
  void push(const WaitingPacket& packet, std::int64_t turn);
  WaitingPacket pop();
  [[nodiscard]] const WaitingPacket& front() const noexcept { return heap_.front().packet; }
  [[nodiscard]] bool empty() const noexcept { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return heap_.size(); }

 private:
  struct Entry {
    Nanoseconds departure;
    std::int64_t turn;
    WaitingPacket packet;
  };
  static bool later(const Entry& a, const Entry& b) noexcept {
    return a.departure != b.departure ? a.departure > b.departure : a.turn > b.turn;
  }
  std::vector<Entry> heap_;
};

}  // namespace forcebound::netem
