#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "forcebound/client/rendering/piece_receipts.hpp"
#include "forcebound/record/histogram.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::lab {

using time::Nanoseconds;

/// Many clients at the same time: the datagrams of each, and the answers to all of them. Their hands move in circles;
/// they bound and apply no forces. With local rendering they ask for the scene and for local models as a client does,
/// and acknowledge the pieces of the scene until all are there; nothing is built of them.
///
/// Time and bytes are arguments; not thread-safe. After the handshakes nothing allocates.
class LoadGenerator {
 public:
  struct Settings {
    std::uint32_t degrees_of_freedom = 3;
    std::string scene{};     ///< requested; empty: the server's default
    double radius_m = 0.02;  ///< of the circles
    double height_m = 0;     ///< of the circles, along z
    bool renders_locally = false;
    std::uint64_t first_nonce{};  ///< of the first client, the others count on
    bool echo = false;            ///< the other end only sends datagrams back: no handshake, motions come back
  };

  /// Results of one measurement; service time is from the motion's sending to the answer's arrival.
  struct Tally {
    std::uint64_t sent = 0;
    std::uint64_t answered = 0;
    std::uint64_t modelled = 0;      ///< of the answers, those with local models
    std::uint64_t foreign = 0;       ///< datagrams that do not answer a motion of this measurement
    record::Histogram arrived_ns{};  ///< until the answer reached this machine's socket
    record::Histogram read_ns{};     ///< until the program had it

    /// Of all motions sent the share `fraction` was answered within this time [ns], as far as the socket; infinite if
    /// fewer were answered at all.
    [[nodiscard]] double answered_within_ns(double fraction) const noexcept;
  };

  /// What all clients have received of scenes, copies included.
  struct HandedOver {
    std::uint64_t pieces = 0;
    std::uint64_t bytes = 0;
  };

  explicit LoadGenerator(Settings settings) : settings_(std::move(settings)) {}

  /// Sets the number of virtual clients; it never shrinks.
  void grow(std::size_t clients);
  [[nodiscard]] std::size_t size() const noexcept { return virtual_clients_.size(); }

  [[nodiscard]] bool connected(std::size_t client) const noexcept { return virtual_clients_[client].session != 0; }

  /// Whether pieces of the scene are missing, which come in return for motions.
  [[nodiscard]] bool wants_pieces(std::size_t client) const noexcept {
    return virtual_clients_[client].pieces_missing > 0;
  }

  /// The datagrams of one client, valid until the next is asked for.
  [[nodiscard]] std::span<const std::byte> hello(std::size_t client, Nanoseconds now) noexcept;
  [[nodiscard]] std::span<const std::byte> motion(std::size_t client, Nanoseconds now) noexcept;
  [[nodiscard]] std::span<const std::byte> bye(std::size_t client) noexcept;

  /// Resets the counts; answers to motions before `now` count as foreign.
  void begin(Nanoseconds now);

  /// @param arrival when the datagram reached this machine's socket, `now` when it was read
  void on_datagram(std::span<const std::byte> datagram, Nanoseconds arrival, Nanoseconds now);

  [[nodiscard]] const Tally& tally() const noexcept { return tally_; }

  [[nodiscard]] const HandedOver& handed_over() const noexcept { return handed_over_; }

  /// The server's reason for refusing a client; empty if it refused none.
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

  /// Whether another Hello may be let in.
  [[nodiscard]] bool refused_for_now() const noexcept { return refused_for_now_; }
  void forget_refusal() noexcept { refusal_.clear(); }

 private:
  struct VirtualClient {
    std::uint64_t nonce;
    std::uint64_t session;  ///< 0: not yet
    std::uint64_t sequence;
    Nanoseconds round_trip{0};   ///< 0: not measured
    std::vector<bool> pieces{};  ///< those that are there
    std::size_t pieces_missing = 0;
    client::PieceReceipts receipts{};
  };

  /// Null: not one of our sessions.
  VirtualClient* virtual_client_of(std::uint64_t nonce) noexcept;
  void on_welcome(const wire::Welcome& welcome);
  void on_refusal(const wire::Refusal& refusal, Nanoseconds now);
  void on_piece(const wire::ScenePiece& piece) noexcept;

  /// False: to a motion from before this measurement.
  bool on_answer(Nanoseconds motion_time, Nanoseconds arrival, Nanoseconds now) noexcept;

  Settings settings_;
  std::vector<VirtualClient> virtual_clients_;
  std::unordered_map<std::uint64_t, std::size_t> client_of_session_;
  wire::Codec codec_;
  Nanoseconds begin_{0};
  Tally tally_;
  HandedOver handed_over_;
  std::string refusal_;
  bool refused_for_now_ = false;
};

}  // namespace forcebound::lab
