#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "forcebound/record/histogram.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::lab {

using time::Nanoseconds;

/// Many clients at the same time: the datagrams of each, and the answers to all of them. Their hands move in circles;
/// they bound and apply no forces.
///
/// Time and bytes are arguments; not thread-safe. After the handshakes nothing allocates.
class LoadGenerator {
 public:
  struct Settings {
    std::uint32_t degrees_of_freedom = 3;
    std::string scene{};          ///< requested; empty: the server's default
    double radius_m = 0.02;       ///< of the circles
    std::uint64_t first_nonce{};  ///< of the first client, the others count on
    bool echo = false;            ///< the other end only sends datagrams back: no handshake, motions come back
  };

  /// Results of one measurement; service time is from the motion's sending to the answer's arrival.
  struct Tally {
    std::uint64_t sent = 0;
    std::uint64_t answered = 0;
    std::uint64_t foreign = 0;       ///< datagrams that do not answer a motion of this measurement
    record::Histogram arrived_ns{};  ///< until the answer reached this machine's socket
    record::Histogram read_ns{};     ///< until the program had it

    /// Of all motions sent the share `fraction` was answered within this time [ns], as far as the socket; infinite if
    /// fewer were answered at all.
    [[nodiscard]] double answered_within_ns(double fraction) const noexcept;
  };

  explicit LoadGenerator(Settings settings) : settings_(std::move(settings)) {}

  /// Sets the number of virtual clients; it never shrinks.
  void grow(std::size_t clients);
  [[nodiscard]] std::size_t size() const noexcept { return virtual_clients_.size(); }

  [[nodiscard]] bool connected(std::size_t client) const noexcept { return virtual_clients_[client].session != 0; }

  /// The datagrams of one client, valid until the next is asked for.
  [[nodiscard]] std::span<const std::byte> hello(std::size_t client, Nanoseconds now) noexcept;
  [[nodiscard]] std::span<const std::byte> motion(std::size_t client, Nanoseconds now) noexcept;
  [[nodiscard]] std::span<const std::byte> bye(std::size_t client) noexcept;

  /// Resets the counts; answers to motions before `now` count as foreign.
  void begin(Nanoseconds now);

  /// @param arrival when the datagram reached this machine's socket, `now` when it was read
  void on_datagram(std::span<const std::byte> datagram, Nanoseconds arrival, Nanoseconds now);

  [[nodiscard]] const Tally& tally() const noexcept { return tally_; }

  /// The server's reason for refusing a client; empty if it refused none.
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

 private:
  struct VirtualClient {
    std::uint64_t nonce;
    std::uint64_t session;  ///< 0: not yet
    std::uint64_t sequence;
    Nanoseconds round_trip{0};  ///< 0: not measured
  };

  /// Null: not one of our sessions.
  VirtualClient* virtual_client_of(std::uint64_t nonce) noexcept;
  void on_refusal(const wire::Refusal& refusal, Nanoseconds now);

  void on_answer(Nanoseconds motion_time, Nanoseconds arrival, Nanoseconds now) noexcept;

  Settings settings_;
  std::vector<VirtualClient> virtual_clients_;
  wire::Codec codec_;
  Nanoseconds begin_{0};
  Tally tally_;
  std::string refusal_;
};

}  // namespace forcebound::lab
