#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "forcebound/net/address_turns.hpp"
#include "forcebound/net/name_lookup.hpp"
#include "forcebound/net/udp_link.hpp"

namespace forcebound::net {

/// A client's end towards a peer by name, which may have several addresses and others later: sends to them by turns
/// until one answers, and looks the name up again as long as none does (AddressTurns).
///
/// Whoever uses it knows the peer as kPeer, wherever it is: datagrams are sent there whatever address is given, and all
/// that are received come from there.
///
/// Real time: `send`, `receive`, `ready` and `keep`, which are of one thread. Any may call the rest.
class PeerLink final : public DatagramLink {
 public:
  static constexpr Address kPeer{};

  /// What shows that the peer was found.
  enum class Found {
    by_session,  ///< the user says so, by `keep`: what answers may be another's by now
    by_answer,   ///< any datagram from there
  };

  /// Both must outlive it, and the lookup may be of several links.
  /// @throws std::runtime_error with the reason, such as no way to an address in digits
  PeerLink(NameLookup& lookup, const time::Clock& clock, Found found);

  bool send(std::span<const std::byte> datagram, const Address& to) noexcept override;
  std::optional<Received> receive(std::span<std::byte> buffer) noexcept override;
  /// Whether an address is known.
  [[nodiscard]] bool ready() const noexcept override { return turns_.current() != nullptr; }

  /// There is a session with the peer where it was last sent to.
  void keep() noexcept;

  [[nodiscard]] UdpCounters counters() const noexcept { return link_.counters(); }
  /// For waiting; the same for ever.
  [[nodiscard]] int descriptor() const noexcept { return link_.descriptor(); }

  /// Where a peer that is known by name was found, in one line, once for each address; else empty. Allocates.
  [[nodiscard]] std::string take_news();

 private:
  void look_up(time::Nanoseconds now) noexcept;
  [[nodiscard]] bool turn_to_current(time::Nanoseconds now) noexcept;
  void store_found() noexcept;

  NameLookup& lookup_;
  const time::Clock& clock_;
  const Found found_;
  UdpLink link_;
  AddressTurns turns_;
  std::uint64_t seen_ = 0;  ///< of `lookup_`
  std::optional<Address> directed_to_{};
  std::optional<Address> found_at_{};  ///< told to who takes the news, or about to be

  std::mutex mutex_;
  std::optional<Address> news_{};
};

}  // namespace forcebound::net
