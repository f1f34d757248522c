#include "forcebound/security/channel.hpp"

#include <sodium.h>

#include <algorithm>
#include <utility>

#include "forcebound/security/internal/little_end.hpp"
#include "forcebound/security/internal/nonce.hpp"
#include "forcebound/security/internal/raw.hpp"

namespace forcebound::security {
namespace {

constexpr std::array kRecordMark{std::byte{'F'}, std::byte{'S'}, std::byte{1}};
constexpr std::size_t kHandshakeAt = 3;
constexpr std::size_t kSessionAt = 4;
constexpr std::size_t kCounterAt = 8;
}  // namespace

bool is_record(std::span<const std::byte> datagram) noexcept {
  return datagram.size() >= kRecordOverhead && std::equal(kRecordMark.begin(), kRecordMark.end(), datagram.begin());
}

std::uint32_t session_of_record(std::span<const std::byte> record) noexcept {
  return little_end_first<std::uint32_t>(record.subspan(kSessionAt, sizeof(std::uint32_t)));
}

void Channel::begin(const SessionNumbers& numbers) noexcept {
  for (std::size_t slot = 0; slot < kSlots; ++slot) forget(slot);
  numbers_ = numbers;
}

bool Channel::install(std::uint8_t handshake, const TransportKeys& keys, Role role, time::Nanoseconds now) noexcept {
  const auto used = [&](std::size_t slot) { return keys_[slot].held && keys_[slot].handshake == handshake; };
  if (used(kCurrent) || used(kPrevious)) return false;
  keys_[kNext] = Key{.held = true, .handshake = handshake, .since = now, .until = now + kKeyExpiresAfter};
  (*secrets_)[kNext] = keys;
  // The other one shows that it has the key by its answer. It still seals with the one before.
  if (role == Role::initiator) make_current(kNext);
  return true;
}

std::optional<std::size_t> Channel::seal(std::span<const std::byte> plain, std::span<std::byte> record,
                                         time::Nanoseconds now) noexcept {
  if (!can_seal(now) || record.size() < kRecordOverhead || record.size() - kRecordOverhead < plain.size()) {
    return std::nullopt;
  }
  if (keys_[kPrevious].held && now >= keys_[kPrevious].until) forget(kPrevious);
  Key& key = keys_[kCurrent];
  const std::uint64_t counter = key.sealed++;
  const auto header = record.first(kRecordHeaderBytes);
  std::ranges::copy(kRecordMark, header.begin());
  header[kHandshakeAt] = std::byte{key.handshake};
  put_little_end_first(numbers_.peer, header.subspan(kSessionAt));
  put_little_end_first(counter, header.subspan(kCounterAt));
  ::crypto_aead_chacha20poly1305_ietf_encrypt(raw(record.subspan(kRecordHeaderBytes)), nullptr, raw(plain),
                                              plain.size(), raw(header), header.size(), nullptr,
                                              nonce_of(counter).data(), raw((*secrets_)[kCurrent].send));
  return plain.size() + kRecordOverhead;
}

Opened Channel::open(std::span<const std::byte> record, std::span<std::byte> plain, time::Nanoseconds now) noexcept {
  if (!is_record(record)) return {Opening::malformed};
  if (session_of_record(record) != numbers_.own) return {Opening::other_session};
  const auto header = record.first(kRecordHeaderBytes);
  const auto sealed = record.subspan(kRecordHeaderBytes);
  const std::size_t bytes = sealed.size() - kTagBytes;
  if (plain.size() < bytes) return {Opening::no_room};

  const auto handshake = std::to_integer<std::uint8_t>(header[kHandshakeAt]);
  std::size_t slot = 0;
  while (slot < kSlots && !(keys_[slot].held && keys_[slot].handshake == handshake)) ++slot;
  if (slot == kSlots) return {Opening::unknown_key};
  if (now >= keys_[slot].until) {
    expire(slot);
    return {Opening::expired};
  }
  const auto counter = little_end_first<std::uint64_t>(header.subspan(kCounterAt));
  if (!keys_[slot].window.is_fresh(counter)) return {Opening::replayed};
  if (::crypto_aead_chacha20poly1305_ietf_decrypt(raw(plain), nullptr, nullptr, raw(sealed), sealed.size(), raw(header),
                                                  header.size(), nonce_of(counter).data(),
                                                  raw((*secrets_)[slot].receive)) != 0) {
    return {Opening::not_authentic};
  }
  keys_[slot].window.add(counter);
  if (!keys_[slot].confirmed) confirm(slot, now);
  return {.result = Opening::opened, .bytes = bytes, .handshake = handshake, .counter = counter};
}

bool Channel::wants_rekey(time::Nanoseconds now) const noexcept {
  const Key& key = keys_[kCurrent];
  return !key.held || now - key.since >= kRekeyAfter || key.sealed >= kRekeyAfterRecords;
}

bool Channel::can_seal(time::Nanoseconds now) const noexcept {
  const Key& key = keys_[kCurrent];
  return key.held && now < key.until && key.sealed < kRecordsMost;
}

void Channel::wipe_expired(time::Nanoseconds now) noexcept {
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    if (keys_[slot].held && now >= keys_[slot].until) expire(slot);
  }
}

void Channel::end_by(time::Nanoseconds end) noexcept {
  for (Key& key : keys_) key.until = std::min(key.until, end);
}

/// It is still known as one that was.
void Channel::expire(std::size_t slot) noexcept {
  wipe(&(*secrets_)[slot], sizeof(TransportKeys));
  keys_[slot].until = time::Nanoseconds::min();  // whatever the time: these bytes are no key any more
}

void Channel::forget(std::size_t slot) noexcept {
  keys_[slot] = {};
  wipe(&(*secrets_)[slot], sizeof(TransportKeys));
}

void Channel::make_current(std::size_t slot) noexcept {
  std::swap(keys_[kPrevious], keys_[kCurrent]);
  std::swap(keys_[kCurrent], keys_[slot]);
  (*secrets_)[kPrevious] = (*secrets_)[kCurrent];
  (*secrets_)[kCurrent] = (*secrets_)[slot];
  forget(slot);
}

void Channel::confirm(std::size_t slot, time::Nanoseconds now) noexcept {
  keys_[slot].confirmed = true;
  if (slot == kPrevious) return;
  if (slot == kNext) make_current(kNext);
  if (keys_[kPrevious].held) keys_[kPrevious].until = std::min(keys_[kPrevious].until, now + kOldKeyKept);
}

}  // namespace forcebound::security
