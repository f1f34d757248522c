#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "forcebound/control/enum_array.hpp"
#include "forcebound/security/locked.hpp"
#include "forcebound/security/noise.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/sequence_window.hpp"

namespace forcebound::security {

/// A sealed datagram: a header in the clear, which is authenticated, then the sealed bytes and their tag.
///
///     0   2  mark 'F' 'S'
///     2   1  version, 1
///     3   1  number of the handshake that the key is from, modulo 256
///     4   4  the receiver's number for this session, little end first
///     8   8  counter of the record under its key, little end first: the nonce
///
/// ChaCha20-Poly1305 (RFC 8439) with Noise's nonce.
inline constexpr std::size_t kRecordHeaderBytes = 16;
inline constexpr std::size_t kRecordOverhead = kRecordHeaderBytes + kTagBytes;

/// A new handshake is wanted after so long, or so many records, under one key.
inline constexpr time::Nanoseconds kRekeyAfter = std::chrono::minutes(2);
inline constexpr std::uint64_t kRekeyAfterRecords = std::uint64_t{1} << 40U;

/// Nothing is sealed or opened under a key that is older or has sealed more.
inline constexpr time::Nanoseconds kKeyExpiresAfter = std::chrono::minutes(6);
inline constexpr std::uint64_t kRecordsMost = std::uint64_t{1} << 41U;

/// After the new key is confirmed, records under the one before are still opened for so long: they may be on their way.
inline constexpr time::Nanoseconds kOldKeyKept = std::chrono::seconds(20);

/// Whether this is a sealed datagram rather than one in the clear; it may still be anybody's.
[[nodiscard]] bool is_record(std::span<const std::byte> datagram) noexcept;

/// The receiver's number for the session, of what `is_record` says is one; anybody can write any.
[[nodiscard]] std::uint32_t session_of_record(std::span<const std::byte> record) noexcept;

enum class Opening : std::uint8_t {
  opened,
  malformed,      ///< no sealed datagram, or too short for one
  no_room,        ///< `plain` is too small
  other_session,  ///< not this end's number
  unknown_key,    ///< of a handshake that is not, no more, or not yet known
  expired,        ///< of a key that is too old
  replayed,       ///< opened before, or too old to tell
  not_authentic,  ///< forged or damaged, or sealed by another key
};
using OpeningCounts = control::EnumArray<Opening, std::uint64_t, 8>;

struct Opened {
  Opening result = Opening::malformed;
  std::size_t bytes = 0;       ///< of `plain` that were written
  std::uint8_t handshake = 0;  ///< of an opened one: whose key it is
  std::uint64_t counter = 0;   ///< and its counter under that
};

/// Both ends' numbers for a session; each end chooses its own.
struct SessionNumbers {
  std::uint32_t own = 0;
  std::uint32_t peer = 0;
};

/// One end of a session after its handshake: seals what it sends, opens what it receives, and changes keys on the way
/// without a gap.
///
/// Each handshake has a number, counted by who begins it. Who began seals with the new key at once, since the answer
/// shows that the other has it. Who answered goes on with the key before until a record under the new one arrives,
/// which confirms it. Until then both open records under either, afterwards for kOldKeyKept more.
///
/// `now` is any steady time of this end. Real time: `seal` and `open` are noexcept and allocate nothing; about 1 us for
/// a datagram. Not thread-safe.
class Channel {
 public:
  /// @throws std::bad_alloc if there is no memory for keys
  explicit Channel(const SessionNumbers& numbers) : numbers_(numbers) {}

  /// Another session: forgets all keys.
  void begin(const SessionNumbers& numbers) noexcept;

  /// Takes the keys of handshake number `handshake`; the answering end keeps only the newest that is not confirmed.
  /// So let later handshakes travel as records of this channel: a first message that somebody repeats would otherwise
  /// take the place of the one that the client waits for.
  /// @return false, and nothing changed, if the number modulo 256 is that of a key in use
  [[nodiscard]] bool install(std::uint8_t handshake, const TransportKeys& keys, Role role,
                             time::Nanoseconds now) noexcept;

  /// Nothing if there is no confirmed key, it is too old or used up, or there is no room for plain.size() +
  /// kRecordOverhead bytes. They must not overlap.
  [[nodiscard]] std::optional<std::size_t> seal(std::span<const std::byte> plain, std::span<std::byte> record,
                                                time::Nanoseconds now) noexcept;

  /// They must not overlap.
  [[nodiscard]] Opened open(std::span<const std::byte> record, std::span<std::byte> plain,
                            time::Nanoseconds now) noexcept;

  /// Wipes keys that have expired. To be called now and then: nothing else does where nothing is sealed or comes.
  void wipe_expired(time::Nanoseconds now) noexcept;

  /// No key lasts longer than that.
  void end_by(time::Nanoseconds end) noexcept;

  /// Whether who begins handshakes should begin one.
  [[nodiscard]] bool wants_rekey(time::Nanoseconds now) const noexcept;

  /// Whether there is a key to seal with that is not too old.
  [[nodiscard]] bool can_seal(time::Nanoseconds now) const noexcept;

  /// The number of the handshake whose key seals; 0 before the first.
  [[nodiscard]] std::uint8_t handshake() const noexcept { return keys_[kCurrent].handshake; }

  [[nodiscard]] const SessionNumbers& numbers() const noexcept { return numbers_; }

 private:
  static constexpr std::size_t kCurrent = 0;
  static constexpr std::size_t kPrevious = 1;
  static constexpr std::size_t kNext = 2;
  static constexpr std::size_t kSlots = 3;

  struct Key {
    bool held = false;
    bool confirmed = false;
    std::uint8_t handshake = 0;
    std::uint64_t sealed = 0;
    time::Nanoseconds since{0};
    time::Nanoseconds until{0};
    time::SequenceWindow window{};
  };

  void expire(std::size_t slot) noexcept;
  void forget(std::size_t slot) noexcept;
  void make_current(std::size_t slot) noexcept;
  void confirm(std::size_t slot, time::Nanoseconds now) noexcept;

  SessionNumbers numbers_;
  std::array<Key, kSlots> keys_{};
  Locked<std::array<TransportKeys, kSlots>> secrets_;
};

}  // namespace forcebound::security
