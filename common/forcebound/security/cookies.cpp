#include "forcebound/security/cookies.hpp"

#include <sodium.h>

#include "forcebound/security/internal/raw.hpp"

namespace forcebound::security {

Cookie Cookies::made_in(time::Nanoseconds::rep period, std::span<const std::byte> address) const noexcept {
  Cookie cookie{};
  ::crypto_generichash_blake2b_state state;
  ::crypto_generichash_blake2b_init(&state, raw(*key_), key_->size(), cookie.size());
  ::crypto_generichash_blake2b_update(&state, raw(std::as_bytes(std::span(&period, 1))), sizeof period);
  ::crypto_generichash_blake2b_update(&state, raw(address), address.size());
  ::crypto_generichash_blake2b_final(&state, raw(cookie), cookie.size());
  wipe(&state, sizeof state);
  return cookie;
}

Cookie Cookies::made_for(std::span<const std::byte> address, time::Nanoseconds now) const noexcept {
  return made_in(now / kPeriod, address);
}

bool Cookies::is_good(const Cookie& cookie, std::span<const std::byte> address, time::Nanoseconds now) const noexcept {
  const Cookie current = made_in(now / kPeriod, address);
  const Cookie before = made_in(now / kPeriod - 1, address);
  const int is_current = ::sodium_memcmp(cookie.data(), current.data(), cookie.size());
  const int is_before = ::sodium_memcmp(cookie.data(), before.data(), cookie.size());
  return is_current == 0 || is_before == 0;
}

}  // namespace forcebound::security
