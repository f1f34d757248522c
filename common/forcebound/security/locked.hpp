#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

namespace forcebound::security {

/// Memory for secrets: between guard pages, locked into RAM as far as the system allows (RLIMIT_MEMLOCK), left out of
/// core files, and zeroed when it is freed (libsodium, "Secure memory"). For set-up only: a few system calls each.
/// @throws std::bad_alloc if there is none; std::runtime_error if libsodium does not start.
[[nodiscard]] void* allocate_locked(std::size_t bytes);
void free_locked(void* memory) noexcept;

/// Zeroes memory in a way that no compiler leaves out. Real time: noexcept, no allocation.
void wipe(void* memory, std::size_t bytes) noexcept;

/// Owns a secret of a plain type in such memory. A moved-from one must not be used.
template <class Secret>
class Locked {
 public:
  Locked() : secret_(::new (allocate_locked(sizeof(Secret))) Secret{}) {
    static_assert(std::is_trivially_destructible_v<Secret>, "it is wiped, not destroyed");
  }

  [[nodiscard]] Secret& operator*() noexcept { return *secret_; }
  [[nodiscard]] const Secret& operator*() const noexcept { return *secret_; }
  [[nodiscard]] Secret* operator->() noexcept { return secret_.get(); }
  [[nodiscard]] const Secret* operator->() const noexcept { return secret_.get(); }

 private:
  struct Free {
    void operator()(void* memory) const noexcept { free_locked(memory); }
  };
  std::unique_ptr<Secret, Free> secret_;
};

}  // namespace forcebound::security
