#include "forcebound/security/locked.hpp"

#include <sodium.h>

#include <stdexcept>

namespace forcebound::security {

void* allocate_locked(std::size_t bytes) {
  static const bool kStarted = ::sodium_init() >= 0;
  if (!kStarted) throw std::runtime_error("libsodium does not start: the system gives it no random numbers");
  void* const memory = ::sodium_malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void free_locked(void* memory) noexcept { ::sodium_free(memory); }

void wipe(void* memory, std::size_t bytes) noexcept { ::sodium_memzero(memory, bytes); }

}  // namespace forcebound::security
