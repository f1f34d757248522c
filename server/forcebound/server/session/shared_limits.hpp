#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "forcebound/server/session/exact_buckets.hpp"
#include "forcebound/server/session/source_buckets.hpp"

namespace forcebound::server {

/// Hellos in a second: of each client that is known, wherever it says to be, and else of each source.
class HelloRate {
 public:
  /// @param key random
  HelloRate(int per_s_max, time::Nanoseconds now, std::uint64_t key);

  /// @param client its key; empty: it is not known
  [[nodiscard]] bool take(std::string_view client, const net::Address& from, time::Nanoseconds now) noexcept;

 private:
  SourceBuckets of_sources_;
  ExactBuckets of_clients_;
};

/// Whether a client without a limit of its own may have one more session: while as many places are free as it has, so
/// that one alone gets half of them, and none takes the last from the others.
[[nodiscard]] constexpr bool is_fair_share(std::size_t of_client, std::size_t of_all, std::size_t most) noexcept {
  return of_all < most && of_client < most - of_all;
}

/// What the servers of one process (its workers) let in together: each session has a place here, so that limits hold
/// for all of them, of sessions exactly, however many ask at once.
///
/// A worker that needs the place of another's session asks for it here, and that one ends the session.
///
/// Looked at for a Hello, at a session's end, a few times a second, and for a motion that came to a worker which has
/// its keys but not its session. Thread-safe; nobody waits for more than a look at each place.
class SharedLimits {
 public:
  /// @param key random
  SharedLimits(int hellos_per_s_max, time::Nanoseconds now, std::uint64_t key);

  /// HelloRate's.
  [[nodiscard]] bool take_hello(std::string_view client, const net::Address& from, time::Nanoseconds now) noexcept;

  /// Who asks. Its address is that of its Hello, also after it has moved.
  struct Asking {
    std::uint64_t session = 0;
    net::Address address;
    std::string client{};  ///< its key; empty: it is not known
  };
  /// Most sessions at once.
  struct Most {
    std::size_t all = 0;
    std::size_t of_address = 0;              ///< 0: no such limit
    std::optional<std::size_t> of_client{};  ///< nothing: of one that is known, its fair share
  };

  /// A session's place; given back at its end.
  class Place {
   public:
    Place() = default;
    Place(Place&& other) noexcept : limits_(std::exchange(other.limits_, nullptr)), session_(other.session_) {}
    Place& operator=(Place&& other) noexcept {
      std::swap(limits_, other.limits_);
      std::swap(session_, other.session_);
      return *this;
    }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;
    ~Place() {
      if (limits_ != nullptr) limits_->give_back(session_);
    }

   private:
    friend class SharedLimits;
    Place(SharedLimits& limits, std::uint64_t session) noexcept : limits_(&limits), session_(session) {}
    SharedLimits* limits_ = nullptr;
    std::uint64_t session_ = 0;
  };

  /// Nothing: one of the limits would be passed. @throws std::bad_alloc
  [[nodiscard]] std::optional<Place> take(Asking asking, const Most& most);

  [[nodiscard]] std::size_t sessions() const noexcept;
  [[nodiscard]] bool has(std::uint64_t session) const noexcept;
  /// And whether this client opened it.
  [[nodiscard]] bool has(std::uint64_t session, std::string_view client) const noexcept;
  /// By the address alone, whatever the port.
  [[nodiscard]] std::size_t sessions_of(const net::Address& address) const noexcept;
  [[nodiscard]] std::size_t sessions_of(std::string_view client) const noexcept;

  /// Since when a session does nothing, where that is reason enough to end it.
  struct Idle {
    std::optional<time::Nanoseconds> for_anybody{};
    std::optional<time::Nanoseconds> for_its_client{};  ///< for another session of the same client
  };

  /// Of the worker that has the session, a few times a second. @return whether somebody has asked for its place since
  [[nodiscard]] bool report_idle(std::uint64_t session, const Idle& idle) noexcept;

  /// Asks for the place of the session that is idle longest, unless one has been asked for and not been ended yet.
  /// @param client of this one's sessions, for another of its own; nothing: of all
  /// @return whether a place will be free soon
  [[nodiscard]] bool ask_for_place(std::optional<std::string_view> client) noexcept;

  /// Own it while an environment is made whose memory is measured, so that no other worker's adds to it. It may belong
  /// to another worker.
  [[nodiscard]] std::unique_lock<std::mutex> try_making() { return std::unique_lock(making_, std::try_to_lock); }

 private:
  struct Entry {
    net::Address address;
    std::string client;
    Idle idle{};
    bool wanted_by_anybody = false;
    bool wanted_by_client = false;
  };
  void give_back(std::uint64_t session) noexcept;
  [[nodiscard]] std::size_t count_of(const net::Address& address) const noexcept;
  [[nodiscard]] std::size_t count_of(std::string_view client) const noexcept;

  mutable std::mutex guard_;
  HelloRate hellos_;
  std::unordered_map<std::uint64_t, Entry> places_;
  std::mutex making_;
};

/// Which of a process's servers this is. Sessions of a server have numbers that the system can tell its socket by.
struct WorkerPlace {
  std::size_t number = 0;
  std::size_t workers = 1;         ///< of the process
  SharedLimits* limits = nullptr;  ///< of all of them; null where there are no others

  static constexpr std::size_t kWorkersMost = 256;

  /// The one to which a session of this number belongs, as the system's filter decides by the number's lowest byte.
  [[nodiscard]] static constexpr std::size_t owner_of(std::uint64_t session, std::size_t workers) noexcept {
    constexpr std::uint64_t kByte = 0xff;
    return static_cast<std::size_t>(session & kByte) % workers;
  }
  [[nodiscard]] constexpr bool owns(std::uint64_t session) const noexcept {
    return owner_of(session, workers) == number;
  }

  /// The one in which a shared scene is: all of its clients must meet there.
  [[nodiscard]] std::size_t home_of(std::string_view scene) const noexcept;
};

}  // namespace forcebound::server
