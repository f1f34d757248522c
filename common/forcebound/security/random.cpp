#include "forcebound/security/random.hpp"

#include <sodium.h>

#include <stdexcept>

namespace forcebound::security {

void fill_with_random(std::span<std::byte> bytes) {
  if (::sodium_init() < 0) throw std::runtime_error("libsodium does not start: the system gives it no random numbers");
  ::randombytes_buf(bytes.data(), bytes.size());
}

}  // namespace forcebound::security
