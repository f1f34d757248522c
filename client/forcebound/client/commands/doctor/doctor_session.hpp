#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "forcebound/client/rendering/piece_receipts.hpp"
#include "forcebound/client/session/clock_offset.hpp"
#include "forcebound/client/session/closing.hpp"
#include "forcebound/client/session/connection.hpp"
#include "forcebound/client/session/force_stream.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::client::commands {

using time::Nanoseconds;

/// What came of asking for a session.
struct Handshake {
  std::uint64_t hellos = 0;          ///< sent until the first Welcome
  Nanoseconds took{0};               ///< from the first Hello to the first Welcome; 0: there was none
  std::uint64_t sessions = 0;        ///< more than one: the server lost or ended one meanwhile
  std::string scene{};               ///< as the server named it, printable
  std::string simulated{};           ///< what the server said it simulates, printable
  std::uint32_t pieces_offered = 0;  ///< of the scene, to run at the client
  wire::ServerParts server_parts = wire::ServerParts::held;
  wire::RefusalReason refused_for = wire::RefusalReason::unspecified;
  std::string refusal{};  ///< the server's reason, printable; empty: it has not refused
};

/// A force that came, as the four times of its exchange.
struct AnsweredMotion {
  std::uint64_t motion = 0;  ///< its number
  client::ClockOffset::Exchange times{};
  Nanoseconds compute{0};  ///< spent on the scene, by the server
};

/// A client that only measures: handshake, counts and clocks are those of forcebound-client, but there is no device.
/// Its hand rests at the origin and gets no force. With local rendering it takes in the pieces of the scene and
/// acknowledges them, so that the traffic is a real client's; nothing is built of them.
///
/// Real time: `tick` is noexcept and, but for a handshake, allocates nothing; answers for which no room was made are
/// counted and not kept. Not thread-safe.
class DoctorSession {
 public:
  struct Settings {
    net::Address server{};
    std::string scene{};  ///< requested; empty: the server's default
    int degrees_of_freedom = 3;
    bool renders_locally = true;
    std::uint64_t seed = 1;      ///< for the nonces of the handshake
    std::size_t answers = 1000;  ///< room for so many
  };

  /// Link and clock must outlive it.
  DoctorSession(const Settings& settings, net::DatagramLink& link, const time::Clock& clock);

  [[nodiscard]] bool connected() const noexcept { return connection_.session() != 0; }
  [[nodiscard]] const Handshake& handshake() const noexcept { return handshake_; }

  /// Asks for a session if there is none, as often as a client does, and takes in what has come.
  void keep_connected() noexcept;

  /// A tick as the client's: sends a motion, or asks for a session, and takes in what has come.
  void tick() noexcept;

  /// Sends a motion in a datagram of that size; allocates. Its number; 0: not sent. @param bytes 0: as it is
  std::uint64_t send_motion(std::size_t bytes);

  /// Takes in what has come.
  void receive() noexcept;

  /// Whether an answer came to that motion or a later one.
  [[nodiscard]] bool is_answered_since(std::uint64_t motion) const noexcept { return newest_answered_ >= motion; }

  /// Ends the session: repeats Bye until the server's counts have not changed for the longest delay seen, so that
  /// datagrams on their way are not counted as lost. To be called about once a millisecond, until it returns true or
  /// the caller's patience is over.
  [[nodiscard]] bool close() noexcept;

  /// In the order of their arrival, of the present session.
  [[nodiscard]] const std::vector<AnsweredMotion>& answers() const noexcept { return answers_; }
  [[nodiscard]] client::ForceStream::Counts counts() const noexcept { return forces_.counts(clock_.now()); }
  [[nodiscard]] const client::ClockOffset& clocks() const noexcept { return clocks_; }

  /// The longest time without a force newer than all before; until `close`, the present one included.
  [[nodiscard]] Nanoseconds longest_gap() const noexcept {
    if (closing_.begun() || newest_arrived_ == Nanoseconds{0}) return longest_gap_;
    return std::max(longest_gap_, clock_.now() - newest_arrived_);
  }

  /// The largest datagram that came, of payload.
  [[nodiscard]] std::size_t largest_bytes() const noexcept { return largest_bytes_; }

  [[nodiscard]] std::uint64_t pieces_received() const noexcept { return pieces_received_; }
  [[nodiscard]] std::uint64_t piece_bytes() const noexcept { return piece_bytes_; }

  /// Datagrams that no message could be read from.
  [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }

 private:
  [[nodiscard]] wire::MotionSample next_motion() noexcept;
  void receive(const wire::Message& message, Nanoseconds arrival) noexcept;
  void receive(const wire::Welcome& welcome, Nanoseconds arrival) noexcept;
  void receive(const wire::Refusal& refusal, Nanoseconds arrival) noexcept;
  void receive(const wire::EnvironmentForce& force, Nanoseconds arrival) noexcept;
  void receive(const wire::ScenePiece& piece) noexcept;
  void receive(const wire::Bye& bye, Nanoseconds arrival) noexcept;

  Settings settings_;
  net::DatagramLink& link_;
  const time::Clock& clock_;
  client::Connection connection_;
  client::ForceStream forces_;
  client::ClockOffset clocks_;
  client::PieceReceipts receipts_;
  wire::Codec codec_;
  std::array<std::byte, net::kDatagramBytesMax + 1> buffer_{};  // one more, so that an oversize datagram shows

  Handshake handshake_;
  Nanoseconds first_hello_{0};
  std::vector<AnsweredMotion> answers_;
  std::uint64_t newest_answered_ = 0;
  Nanoseconds newest_arrived_{0};  // 0: none yet in this session
  Nanoseconds longest_gap_{0};
  std::size_t largest_bytes_ = 0;
  std::vector<bool> pieces_;  // those that are there
  std::size_t pieces_missing_ = 0;
  std::uint64_t pieces_received_ = 0;
  std::uint64_t piece_bytes_ = 0;
  std::uint64_t malformed_ = 0;

  client::Closing closing_;
};

}  // namespace forcebound::client::commands
