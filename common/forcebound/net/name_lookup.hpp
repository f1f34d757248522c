#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/net/address_turns.hpp"
#include "forcebound/net/endpoint.hpp"

namespace forcebound::net {

/// Looks a peer's name up, at once and again whenever that is asked for, on a thread of its own: the system may take
/// seconds for it. For an address in digits there is neither thread nor question.
///
/// Any thread may call all of it.
class NameLookup {
 public:
  /// Between two lookups at least, so that many who ask ask no name server in vain.
  static constexpr time::Nanoseconds kPause = std::chrono::seconds{1};

  /// Looks it up for the first time. What is not found now may be found later.
  /// @param resolver finds addresses; also called on the thread
  /// @throws what is no std::runtime_error of the resolver: such a peer is not accepted at all
  explicit NameLookup(Endpoint endpoint, Resolver resolver = look_up);
  /// Does not wait for a lookup under way: its result is dropped.
  ~NameLookup();
  NameLookup(const NameLookup&) = delete;
  NameLookup& operator=(const NameLookup&) = delete;

  /// Has it looked up again. Real time: returns at once, allocates nothing.
  void ask() noexcept;

  /// The newest addresses, as far as AddressTurns takes them, once for each lookup that found some: `seen` says which
  /// one the caller has, 0 at first. False: there are no newer ones, or they are just being written. Real time, too.
  [[nodiscard]] bool update_turns(std::uint64_t& seen, AddressTurns& turns, time::Nanoseconds now) const noexcept;

  [[nodiscard]] const Endpoint& endpoint() const noexcept;
  /// Not an address in digits.
  [[nodiscard]] bool is_name() const noexcept;

  // Not real time.

  [[nodiscard]] std::vector<Address> addresses() const;
  /// How many lookups have ended.
  [[nodiscard]] std::uint64_t ended() const noexcept;
  /// Why the last one found nothing; empty: it found something.
  [[nodiscard]] std::string problem() const;

  /// "haptics:47800 (at [2001:db8::1]:47800, 192.0.2.1:47800)", "127.0.0.1:47800", or with why there is no address.
  [[nodiscard]] std::string in_words() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace forcebound::net
