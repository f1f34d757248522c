#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "forcebound/server/session/source_buckets.hpp"

namespace forcebound::server {

/// What the servers of one process (its workers) let in together: each session has a place here, so that limits hold
/// for all of them exactly, however many ask at once.
///
/// Looked at for a Hello and at a session's end alone, never for a motion. Thread-safe.
class SharedLimits {
 public:
  /// @param key random
  SharedLimits(int hellos_per_s_max, time::Nanoseconds now, std::uint64_t key);

  /// Whether a Hello from there is within its source's rate.
  [[nodiscard]] bool take_hello(const net::Address& from, time::Nanoseconds now) noexcept;

  /// Who asks. Its address is that of its Hello, also after it has moved.
  struct Asking {
    std::uint64_t session = 0;
    net::Address address;
    std::string client{};
  };
  /// Most sessions at once.
  struct Most {
    std::size_t all = 0;
    std::size_t of_address = 0;  ///< 0: no such limit
    std::optional<std::size_t> of_client{};
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
  /// By the address alone, whatever the port.
  [[nodiscard]] std::size_t sessions_of(const net::Address& address) const noexcept;
  [[nodiscard]] std::size_t sessions_of(std::string_view client) const noexcept;

  /// Held while an environment is made, so that its memory is not taken for that of another's.
  [[nodiscard]] std::unique_lock<std::mutex> making() { return std::unique_lock(making_); }

 private:
  struct Entry {
    net::Address address;
    std::string client;
  };
  void give_back(std::uint64_t session) noexcept;
  [[nodiscard]] std::size_t count_of(const net::Address& address) const noexcept;
  [[nodiscard]] std::size_t count_of(std::string_view client) const noexcept;

  mutable std::mutex guard_;
  SourceBuckets hellos_;
  std::unordered_map<std::uint64_t, Entry> places_;
  std::mutex making_;
};

/// Which of a process's servers this is. Sessions of a server have numbers that the system can tell its socket by.
struct WorkerPlace {
  std::size_t number = 0;
  std::size_t of = 1;              ///< 1: there are no others
  SharedLimits* limits = nullptr;  ///< of all of them; null where there are no others

  static constexpr std::size_t kMost = 256;

  /// The one to which a session of this number belongs, as the system's filter decides by the number's lowest byte.
  [[nodiscard]] static constexpr std::size_t owner_of(std::uint64_t session, std::size_t workers) noexcept {
    constexpr std::uint64_t kByte = 0xff;
    return static_cast<std::size_t>(session & kByte) % workers;
  }
  [[nodiscard]] constexpr bool owns(std::uint64_t session) const noexcept { return owner_of(session, of) == number; }

  /// The one in which a shared scene is: all of its clients must meet there.
  [[nodiscard]] std::size_t home_of(std::string_view scene) const noexcept;
};

}  // namespace forcebound::server
