#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "forcebound/security/channel.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/security/keys.hpp"
#include "forcebound/security/known_servers.hpp"
#include "forcebound/security/locked.hpp"
#include "forcebound/security/noise.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// Whom a client believes, and how it shows who it is.
struct Identity {
  security::Pattern pattern = security::Pattern::ik_psk2;
  std::string server;                               ///< HOST:PORT as the user wrote it
  std::optional<security::KeyPair> own{};           ///< ik_psk2: must be there
  std::optional<security::PublicKey> server_key{};  ///< ik_psk2: as given; nothing: as in `known`
  std::optional<security::KnownServers> known{};    ///< ik_psk2 without `server_key`: must be there
  security::NewServers new_servers = security::NewServers::refused;
  std::optional<security::SecretKey> shared{};  ///< nn_psk0: must be there
};

/// The client's side of handshakes, apart from the tick: the products on the curve take tenths of a millisecond, and a
/// server that is new is written into a file.
///
/// A request is sent again after 0.1 s, then after twice as long, up to 2 s; the same one, so that an answer that comes
/// late still fits. After 30 s another is made.
///
/// A cookie is not authentic, and somebody beside the path may send others first, as many as he likes. So one by
/// chance of those that came since the last try is tried, at most 50 a second (60 kB: less than a session sends); the
/// server answers a wrong one with the right one. Who wants to keep the client out for long must send hundreds for each
/// of those.
///
/// Two threads meet here: the tick's calls what stands under "tick", one other calls `work`. The rest is for any.
class Handshaker {
 public:
  using FillRandom = std::function<void(std::span<std::byte>)>;

  /// @param random fills with bytes that nobody can guess; called by `work` alone
  /// @throws std::invalid_argument if a key is missing that the pattern needs
  Handshaker(Identity identity, FillRandom random);
  ~Handshaker();
  Handshaker(const Handshaker&) = delete;
  Handshaker& operator=(const Handshaker&) = delete;

  /// Does what is due: at most two handshake messages and a write to a file. To be called every few milliseconds.
  void work(Nanoseconds now);

  /// What stands between the client and encrypted datagrams, in one line; empty: nothing that is known.
  [[nodiscard]] std::string problem() const;

  /// The newest handshake of a session, in one line for people, once; else empty.
  [[nodiscard]] std::string take_news();

  [[nodiscard]] security::Pattern pattern() const noexcept { return identity_.pattern; }

  // Tick. Real time: noexcept, no allocation, no waiting.

  enum class Wanted : std::uint8_t {
    nothing,
    session,   ///< the first handshake of a new session
    next_key,  ///< a later one of the session that there is
  };

  /// @param handshake the number of the one that the newest key is from
  void want(Wanted what, std::uint8_t handshake) noexcept;

  /// A datagram that `is_handshake`, or the content of a sealed one that is. False: not awaited, or no room.
  bool receive(std::span<const std::byte> datagram) noexcept;

  /// A datagram to send.
  struct Outgoing {
    std::array<std::byte, security::kRequestBytes> bytes{};
    std::size_t length = 0;
    bool sealed = false;  ///< as the content of a sealed datagram
  };
  /// Takes the oldest that waits, if any.
  [[nodiscard]] bool take(Outgoing& outgoing) noexcept;

  /// Keys that came out of a handshake; they are wiped by `keys_taken`.
  struct Made {
    security::SessionNumbers numbers{};
    std::uint8_t handshake = 0;  ///< its number
    bool of_new_session = false;
    const security::TransportKeys* keys = nullptr;
  };
  [[nodiscard]] std::optional<Made> made() const noexcept;

  /// To be called after `want`, which says what next.
  void keys_taken() noexcept;

 private:
  struct Incoming {
    std::array<std::byte, security::kAnswerBytesMost> bytes{};
    std::size_t length = 0;
  };
  struct Queues;

  /// A cookie that has not been tried, and the key that is believed to be the server's.
  struct Offer {
    security::Cookie cookie{};
    std::optional<security::PublicKey> server{};
    bool operator==(const Offer&) const = default;
  };
  static constexpr std::size_t kOffersMost = 64;

  void begin(Wanted what, Nanoseconds now);
  void end() noexcept;
  void write_message();
  void say(Nanoseconds now);
  void on_received(std::span<const std::byte> datagram, Nanoseconds now);
  void on_offer(const security::CookieOffer& offer);
  void try_an_offer(Nanoseconds now);
  void on_answer(const security::HandshakeAnswer& answer, Nanoseconds now);
  void on_admitted(const security::Admission& admission);
  [[nodiscard]] std::size_t below(std::size_t end);
  [[nodiscard]] std::optional<security::PublicKey> key_to_expect(const security::PublicKey& offered);
  void set_problem_if_silent(Nanoseconds now);
  void set_problem(std::string text);

  Identity identity_;
  FillRandom random_;

  // Of `work`.
  Wanted task_ = Wanted::nothing;
  security::HandshakeTopic topic_{};
  security::Cookie cookie_{};
  std::optional<security::PublicKey> expected_;
  std::optional<security::Handshake> handshake_;
  std::array<std::byte, security::kSealedRequestBytesMost> message_{};
  std::size_t message_bytes_ = 0;
  security::ProofKeys proof_keys_{};  ///< of the message's
  std::uint32_t session_client_ = 0;  ///< numbers of the session that there is
  std::uint32_t session_server_ = 0;
  Nanoseconds begun_{0};
  Nanoseconds next_sent_{0};
  Nanoseconds pause_{0};
  std::vector<Offer> offers_;
  Nanoseconds next_try_{Nanoseconds::min()};
  Nanoseconds next_key_{Nanoseconds::min()};  ///< when another key may be expected

  // Between both.
  std::atomic<Wanted> wanted_{Wanted::nothing};
  std::atomic<std::uint8_t> newest_handshake_{0};
  std::atomic<std::uint32_t> awaited_{0};  ///< the client's number in what is heard; 0: nothing is awaited
  std::atomic<bool> made_ready_{false};
  Made made_{};
  security::Locked<security::TransportKeys> keys_;
  std::unique_ptr<Queues> queues_;

  mutable std::mutex texts_;
  std::string problem_;
  std::string news_;
};

}  // namespace forcebound::client
