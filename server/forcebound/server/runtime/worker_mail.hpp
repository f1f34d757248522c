#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/security/secure_link.hpp"

namespace forcebound::server {

class UdpServer;

/// What other threads put down for a worker: datagrams that came to the wrong socket, and work that must be done on its
/// thread. Bounded: what finds no room is lost, as a datagram may be.
///
/// Thread-safe. For the worker itself a look at an empty one costs a read of an atomic.
class WorkerMail {
 public:
  static constexpr std::size_t kDatagramsMost = 256;

  /// A datagram; or with keys, what was sealed in it, as their session of keys moves to this worker.
  struct Handed {
    net::Address from{};
    std::size_t length = 0;
    std::array<std::byte, net::kDatagramBytesMax> bytes{};
    std::optional<SecureLink::Moving> keys{};
  };
  enum class Put { taken, taken_first, no_room };

  WorkerMail() : ring_(std::make_unique<std::array<Handed, kDatagramsMost>>()) {}

  /// `taken_first`: its worker may sleep, and has to be woken up. Allocates nothing.
  [[nodiscard]] Put put(std::span<const std::byte> datagram, const net::Address& from,
                        std::optional<SecureLink::Moving> keys = std::nullopt) noexcept;

  /// The worker is to be woken up after it.
  void ask(std::function<void(UdpServer&)> work);

  /// Of the worker's thread: the oldest datagram. False: there is none.
  [[nodiscard]] bool take(Handed& to) noexcept;
  [[nodiscard]] std::vector<std::function<void(UdpServer&)>> take_work();
  [[nodiscard]] bool empty() const noexcept { return waiting_.load(std::memory_order_acquire) == 0; }

 private:
  std::mutex guard_;
  std::unique_ptr<std::array<Handed, kDatagramsMost>> ring_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::vector<std::function<void(UdpServer&)>> work_;
  std::atomic<std::size_t> waiting_{0};  ///< datagrams and work
};

}  // namespace forcebound::server
