#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/security/channel.hpp"
#include "forcebound/security/cookies.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/server/security/address_owners.hpp"
#include "forcebound/server/security/moved_keys.hpp"
#include "forcebound/server/security/request_judge.hpp"
#include "forcebound/server/security/secure_counters.hpp"
#include "forcebound/server/security/server_keys.hpp"
#include "forcebound/server/security/waiting_handshakes.hpp"
#include "forcebound/server/session/exact_buckets.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/server/session/source_buckets.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/token_bucket.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::server {

/// How many a SecureLink has keys for, and how long. Each worker's link has these limits for itself, as has those for
/// handshakes.
struct SecureLimits {
  std::size_t sessions_max = 64;                        ///< of the server behind it
  Nanoseconds idle_timeout = std::chrono::seconds{60};  ///< of its sessions

  std::size_t worker = 0;  ///< of the server behind it; numbers of sessions of keys tell it
  std::size_t workers = 1;
  MovedKeys* moved = nullptr;  ///< of all workers; null where there are no others

  /// Sessions of keys that can be confirmed: twice those of the server, since a client that lost its keys begins
  /// another while the one before is still there.
  [[nodiscard]] constexpr std::size_t confirmed_most() const noexcept { return confirmed_most_of(sessions_max); }
  [[nodiscard]] static constexpr std::size_t confirmed_most_of(std::size_t sessions) noexcept {
    return 2 * sessions + 8;
  }
};

/// Opens what clients have sealed and seals what is sent to them: a link in front of another, of which the server
/// behind it knows nothing. Answers handshakes (handshake_datagram.hpp), first ones in the clear, later ones in sealed
/// datagrams.
///
/// - **Nothing is kept for who asks**, nor computed but hashes, before it has sent a cookie back from its address.
/// - **Handshakes wait** (waiting_handshakes.hpp) for `answer_waiting`, which makes one at a time: records are opened
///   before, however many ask.
/// - **A request that is proven** (request_proof.hpp) is one of a client of the list, or by who knows the shared key,
///   and no recorded one. It gets keys here for 10 s, as have 64 such at most, and of a client of the list two: another
///   of its requests is answered when one of these is free. Without a list the source that has most of the 64 loses its
///   oldest. A sealed datagram confirms the keys: twice `sessions_max` and 8 more may be confirmed.
/// - **A request that is not proven** gets no keys. Whose key the list lacks is told so, and who has another shared key
///   gets an answer that it cannot read; of all such 100 in a second, and of a source one.
/// - **A client with a most of sessions** may have confirmed as many for each; the next takes the place of the one that
///   was silent longest.
/// - **A copy of a request** gets the same answer again, and no keys of its own.
/// - **A session of keys ends** when nothing was opened for 20 s longer than `idle_timeout`, or its key has expired.
/// - **Keys move** to the worker that has the session or the shared scene of what was sealed with them, and stay there:
///   all sessions under the same keys should be of one worker, or most of their motions are lost.
/// - **No answer is longer than its question**, and there are limits to answers: of cookies and refusals by source,
/// which
///   forged addresses can use up, apart from handshakes, which they cannot; of these 10 a second and 30 at once for
///   each client of the list, without one for each source.
/// - **A Hello in the clear** is refused with the reason; all else in the clear is dropped.
/// - **What goes to an address** is sealed by the session of keys of which the newest record came from there. A session
///   keeps its newest two addresses.
///
/// Without a list of clients whoever knows the shared key is let in, and the server knows of nobody who it is.
///
/// `now` is the clock's time. Randomness is an argument. Real time: `accept` of records and `send` are noexcept and
/// allocate nothing, about 1 us each. A handshake takes about 0.2 ms of the thread that calls `answer_waiting`, and
/// allocates. Not thread-safe.
class SecureLink final : public net::DatagramLink {
 public:
  using FillRandom = std::function<void(std::span<std::byte>)>;

  static constexpr std::size_t kUnconfirmedMost = 64;
  static constexpr Nanoseconds kUnconfirmedKept = std::chrono::seconds{10};
  static constexpr Nanoseconds kKeptAfterIdle = std::chrono::seconds{20};

  /// @param fill_random fills with bytes that nobody can guess
  /// @param observer of what is refused; may be null. All must outlive it.
  /// @throws std::invalid_argument if there is neither a key pair nor a shared key
  SecureLink(ServerKeys keys, const SecureLimits& limits, net::DatagramLink& link, const time::Clock& clock,
             FillRandom fill_random, ServerObserver* observer = nullptr);
  ~SecureLink() override;
  SecureLink(const SecureLink&) = delete;
  SecureLink& operator=(const SecureLink&) = delete;

  /// What was sealed, and by whom.
  struct Content {
    std::span<const std::byte> bytes;                 ///< valid until the next call
    const security::AllowedClient* client = nullptr;  ///< null: the server has no list
    std::uint32_t keys = 0;                           ///< this end's number for the session of keys
  };

  /// A session of keys on its way to the link of another worker.
  class Moving;

  /// Whether the other worker was given it.
  using Give = std::function<bool(Moving&)>;

  enum class MovedOut : std::uint8_t {
    moved,
    not_taken,  ///< by the other
    too_often,  ///< a session of keys moves 5 times at once, then once a second
    too_many,   ///< have moved, of all or of its client
  };

  /// Moves it to another worker: that one has it once `give` has taken it, and this link until then; so if not, nothing
  /// has changed. Allocates nothing.
  [[nodiscard]] MovedOut move_out(std::uint32_t keys, std::size_t worker, Nanoseconds now, const Give& give) noexcept;

  /// Takes it in, for which there is always room; what was sealed came from `from`. @return its client's entry here, as
  /// Content has it; nothing, and the keys are no more: this link's list lacks the client.
  [[nodiscard]] std::optional<const security::AllowedClient*> move_in(Moving moving, const net::Address& from,
                                                                      Nanoseconds now) noexcept;

  /// The other worker that has the keys of this record.
  [[nodiscard]] std::optional<std::size_t> moved_to(std::span<const std::byte> record) const noexcept;

  /// A datagram that arrived at `now`. Nothing if it has no content for the server. A handshake waits for
  /// `answer_waiting`.
  std::optional<Content> accept(std::span<const std::byte> datagram, const net::Address& from,
                                Nanoseconds now) noexcept;

  /// Makes the handshake that has waited longest. To be called when no record waits to be opened.
  void answer_waiting(Nanoseconds now) noexcept;

  /// Whether a handshake waits.
  [[nodiscard]] bool has_waiting() const noexcept { return !waiting_.empty(); }

  /// Seals it. False if nothing was opened from there, or the keys have expired.
  bool send(std::span<const std::byte> datagram, const net::Address& to) noexcept override;

  /// `accept` of what waits in the other link, and when nothing does, the handshakes of it: the content of the oldest
  /// sealed datagram; after many without any, nothing.
  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override;

  /// Lets in whom this list has, from now on, and forgets the keys of clients that it does not have. Nothing changes
  /// where there was no list. Not real time.
  void replace_clients(security::AllowedClients clients);

  /// Forgets keys that are not used. To be called a few times a second.
  void on_timer(Nanoseconds now) noexcept;

  [[nodiscard]] security::Pattern pattern() const noexcept { return keys_.pattern(); }
  /// Null for NNpsk0.
  [[nodiscard]] const security::PublicKey* public_key() const noexcept {
    return keys_.own ? &keys_.own->public_key : nullptr;
  }
  [[nodiscard]] const SecureCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::size_t confirmed() const noexcept { return confirmed_; }
  [[nodiscard]] std::size_t unconfirmed() const noexcept { return peers_.size() - confirmed_; }

 private:
  static constexpr std::size_t kAskedBytes = security::kKeyBytes;

  /// A request, as far as a copy of it is recognised by, and its answer.
  struct Answered {
    bool in_clear = true;
    security::HandshakeTopic topic{};
    std::array<std::byte, kAskedBytes> asked{};  ///< the message's key, which is of no other one
    std::array<std::byte, security::kAnswerBytesMost> bytes{};
    std::size_t length = 0;
  };

  struct Peer {
    security::Channel channel;
    time::TokenBucket later;  ///< handshakes
    time::TokenBucket moves;  ///< to other workers
    const security::AllowedClient* client = nullptr;
    security::PublicKey key{};  ///< of IKpsk2
    std::uint64_t charged = 0;  ///< who was for its handshake: RequestJudge's
    Answered answered{};
    std::uint64_t asked_at = 0;  ///< counter of the record with the newest later request, under the key that sealed it
    std::uint8_t asked_under = 0;  ///< the number of that key's handshake; 0: there was none
    RecentAddresses places{};
    Nanoseconds received{0};  ///< when a record was opened; before the first: when it asked
    bool confirmed = false;
  };
  using Peers = std::unordered_map<std::uint32_t, Peer>;

  /// What was decided about who asked.
  struct Decision {
    security::Verdict verdict = security::Verdict::let_in;
    const security::AllowedClient* client = nullptr;
  };

  std::optional<Content> open_record(std::span<const std::byte> record, const net::Address& from, Nanoseconds now);
  void receive_clear(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now);
  void forget(Peers::iterator peer) noexcept;
  [[nodiscard]] bool is_from_elsewhere(std::uint32_t number) const noexcept;
  /// Whether as many of its own numbers are here as may be confirmed. Of those that moved there are few anyway.
  [[nodiscard]] bool is_full() const noexcept;
  /// What was opened came from there.
  void assign_address(std::uint32_t number, Peer& peer, const net::Address& from, Nanoseconds now) noexcept;
  void confirm(Peers::iterator peer) noexcept;
  /// @param newest is not forgotten
  void keep_to_most_of(const security::AllowedClient& client, Peers::iterator newest) noexcept;
  /// Whether what goes to the address may be sealed for this session from now on.
  [[nodiscard]] bool may_own(const net::Address& address, std::uint32_t number, const Peer& peer,
                             Nanoseconds now) const noexcept;

  // Handshakes.
  using Waiting = WaitingHandshakes::Waiting;
  void on_request(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now);
  void on_later_request(std::uint32_t keys, const security::Opened& record, std::span<const std::byte> content,
                        const net::Address& from);
  void judge(const security::HandshakeRequest& request, const net::Address& from, Nanoseconds now) noexcept;
  void put(Waiting& waiting, const security::HandshakeRequest& request) noexcept;
  void offer_cookie(const security::HandshakeTopic& topic, const net::Address& from, Nanoseconds now);
  /// Whether a handshake was read for it.
  bool answer(const Waiting& waiting, Nanoseconds now);
  void on_first(const security::HandshakeRequest& request, std::uint64_t charged, const net::Address& from,
                Nanoseconds now);
  void refuse_unproven(const security::HandshakeRequest& request, const net::Address& from);
  bool on_later(Peer& peer, const Waiting& waiting, Nanoseconds now);
  void answer_later(Peer& peer, const net::Address& from, Nanoseconds now);
  void send_answer(const Answered& answered, const net::Address& to) noexcept;
  [[nodiscard]] bool install(Peer& peer, const security::HandshakeTopic& topic, const security::Handshake& handshake,
                             Nanoseconds now) noexcept;
  [[nodiscard]] bool fits(const security::HandshakeTopic& topic) const noexcept {
    return topic.pattern == keys_.pattern();
  }
  [[nodiscard]] const Peer* asked_before(const security::HandshakeRequest& request) const noexcept;
  /// Nothing, and counted, if it is not authentic.
  [[nodiscard]] std::optional<security::Handshake> read(const security::HandshakeRequest& request,
                                                        const security::SecretKey* shared);
  [[nodiscard]] const security::SecretKey* shared() const noexcept { return keys_.shared ? &*keys_.shared : nullptr; }
  [[nodiscard]] bool has_list() const noexcept { return keys_.own && keys_.clients; }
  /// Its entry in the list; null, counted and reported: it has none.
  [[nodiscard]] const security::AllowedClient* listed(const security::Handshake& handshake, const net::Address& from);
  [[nodiscard]] Decision decide(const security::Handshake& handshake, const net::Address& from);
  /// Null if there is no memory for it.
  [[nodiscard]] Peer* make_peer(const security::HandshakeTopic& topic, std::uint64_t charged, Nanoseconds now);
  [[nodiscard]] std::size_t unconfirmed_of(std::uint64_t charged) const noexcept;
  void make_room();
  /// Of its own numbers: forgets the session of keys that was silent longest of whoever has most; false: nobody has
  /// more than one more than who asks.
  [[nodiscard]] bool evict_from_who_has_most(const security::Handshake& asking);
  /// False, and counted, if who asked has a key that nobody can have.
  [[nodiscard]] bool write_answer(security::Handshake& handshake, const security::HandshakeRequest& request,
                                  const security::Admission& admission, Answered& answered);
  [[nodiscard]] std::uint32_t new_number();
  [[nodiscard]] security::SecretKey random_key();
  template <class Value>
  [[nodiscard]] Value random() {
    Value value{};
    fill_random_(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }

  ServerKeys keys_;
  SecureLimits limits_;
  net::DatagramLink& link_;
  const time::Clock& clock_;
  FillRandom fill_random_;
  ServerObserver nobody_;
  ServerObserver& observer_;
  Peers peers_;  ///< by this end's number for the session of keys
  std::size_t confirmed_ = 0;
  std::size_t from_elsewhere_ = 0;  ///< of these: of another worker's numbers
  AddressOwners owners_;
  security::Cookies cookies_;
  SourceBuckets unreached_;  ///< answers to who has not shown that it receives at its address
  RequestJudge judge_;
  time::TokenBucket judgements_;
  ExactBuckets handshakes_;  ///< that are proven, by who is charged for them
  ExactBuckets unproven_;    ///< by source
  time::TokenBucket all_unproven_;
  WaitingHandshakes waiting_;
  security::Locked<security::TransportKeys> fresh_;  ///< on their way from a handshake to a channel
  wire::Codec codec_;
  std::array<std::byte, net::kDatagramBytesMax> plain_{};
  std::array<std::byte, net::kDatagramBytesMax> sealed_{};
  SecureCounters counters_;
};

class SecureLink::Moving {
 public:
  Moving(Moving&&) noexcept = default;
  Moving& operator=(Moving&&) noexcept = default;

 private:
  friend class SecureLink;
  explicit Moving(Peers::node_type node) noexcept : node_(std::move(node)) {}
  Peers::node_type node_;
};

}  // namespace forcebound::server
