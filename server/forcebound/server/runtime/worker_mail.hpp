#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/security/secure_link.hpp"
#include "forcebound/server/session/shared_limits.hpp"

namespace forcebound::server {

class UdpServer;

/// What other threads put down for a worker: datagrams that are for it, and work that must be done on its thread.
/// Bounded: what finds no room is lost, as a datagram may be. Of datagrams as they came, which anybody can send, there
/// is room for some of each sender and for 48 of each session of keys, so that Hellos and keys find room beside them:
/// while a worker makes a scene for longer than those take to come, a session's newest are lost.
///
/// Thread-safe. For the worker itself a look at an empty one costs a read of an atomic.
class WorkerMail {
 public:
  static constexpr std::size_t kDatagramsMost = 256;
  static constexpr std::size_t kAsTheyCameMost = 192;
  static constexpr std::size_t kOfWorkerMost = 128;  ///< as they came to one worker
  static constexpr std::size_t kOfKeysMost = 48;     ///< as they came, under one session of keys

  /// What its worker has to do with a datagram.
  enum class Stage : std::uint8_t {
    as_it_came,    ///< nothing was done with it: treat it as if it had come here
    opened,        ///< what was sealed in it, with its keys
    hello_judged,  ///< a Hello that its sender has counted and found within its rate; opened, where there are keys
  };
  struct Datagram {
    std::span<const std::byte> bytes;
    net::Address from{};
    std::size_t worker = 0;  ///< to whose socket it came
    Stage stage = Stage::as_it_came;
  };

  /// A datagram that was taken.
  struct Handed {
    net::Address from{};
    Stage stage = Stage::as_it_came;
    std::optional<SecureLink::Moving> keys{};  ///< its session of keys, which moves to this worker
    std::size_t length = 0;
    std::array<std::byte, net::kDatagramBytesMax> bytes{};
  };
  enum class Put : std::uint8_t { taken, was_empty, no_room };

  WorkerMail() : ring_(std::make_unique<std::array<Handed, kDatagramsMost>>()) {}

  /// Allocates nothing. @param keys that move with it; without room they stay where they are
  /// @return `was_empty`: taken, and its worker may sleep and has to be woken up
  [[nodiscard]] Put put(const Datagram& datagram, SecureLink::Moving* keys = nullptr) noexcept;

  /// The worker is to be woken up after it.
  void post_work(std::function<void(UdpServer&)> work);

  /// Whether all that was posted has been done.
  [[nodiscard]] bool work_done() const noexcept { return undone_.load(std::memory_order_acquire) == 0; }

  /// Of the worker's thread: the oldest datagram. False: there is none.
  [[nodiscard]] bool take(Handed& to) noexcept;

  /// Of the worker's thread: does the work that was posted, in order. What finds no memory is kept for the next call.
  void do_work(UdpServer& server);

  /// Whether no datagram waits. Work may: its worker is woken up for it, and what found no memory then is tried again
  /// at the next turn, which may sleep first.
  [[nodiscard]] bool empty() const noexcept { return waiting_.load(std::memory_order_acquire) == 0; }

 private:
  /// Of those that wait as they came: few enough to compare for each.
  struct Origin {
    bool as_it_came = false;
    std::uint32_t keys = 0;  ///< 0: none
    std::size_t worker = 0;
  };
  [[nodiscard]] bool has_room_for(const Origin& origin) const noexcept;

  std::mutex guard_;
  std::unique_ptr<std::array<Handed, kDatagramsMost>> ring_;
  std::array<Origin, kDatagramsMost> origins_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::vector<std::function<void(UdpServer&)>> posted_;
  std::vector<std::function<void(UdpServer&)>> doing_;  ///< the worker's own
  std::atomic<std::size_t> waiting_{0};                 ///< datagrams
  std::atomic<std::size_t> undone_{0};
};

}  // namespace forcebound::server
