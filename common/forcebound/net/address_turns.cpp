#include "forcebound/net/address_turns.hpp"

#include <algorithm>

namespace forcebound::net {

using time::Nanoseconds;

void AddressTurns::set(std::span<const Address> addresses, Nanoseconds now) noexcept {
  const auto found = addresses.first(std::min(addresses.size(), kAddressesMost));
  if (std::ranges::equal(found, std::span(addresses_).first(count_))) return;
  const Address* const before = current();
  const auto same = before == nullptr ? found.end() : std::ranges::find(found, *before);
  const bool stays = same != found.end();
  current_ = stays ? static_cast<std::size_t>(same - found.begin()) : 0;
  count_ = found.size();
  std::ranges::copy(found, addresses_.begin());
  turn_ = kTurnLeast;
  if (stays) return;
  since_ = now;
  reached_ = Reached::nothing;
}

Nanoseconds AddressTurns::turn() const noexcept {
  if (reached_ == Reached::session) return kSilence;
  return reached_ == Reached::something ? kAnswered : turn_;
}

void AddressTurns::before_sending(Nanoseconds now) noexcept {
  if (now - since_ >= turn()) next(now);
}

void AddressTurns::next(Nanoseconds now) noexcept {
  if (count_ < 2) return;
  if (++current_ == count_) {
    current_ = 0;
    turn_ = std::min(2 * turn_, kTurnMost);
  }
  since_ = now;
  reached_ = Reached::nothing;
}

void AddressTurns::on_unreachable(Nanoseconds now) noexcept {
  if (reached_ == Reached::nothing) next(now);
}

void AddressTurns::on_received() noexcept {
  if (reached_ == Reached::nothing) reached_ = Reached::something;
}

void AddressTurns::on_session(Nanoseconds now) noexcept {
  reached_ = Reached::session;
  since_ = now;
  turn_ = kTurnLeast;
  look_up_at_ = now + kLookUpLeast;
  look_up_pause_ = kLookUpLeast;
}

bool AddressTurns::look_up_due(Nanoseconds now) noexcept {
  if (now < look_up_at_) return false;
  look_up_at_ = now + look_up_pause_;
  look_up_pause_ = std::min(2 * look_up_pause_, kLookUpMost);
  return true;
}

}  // namespace forcebound::net
