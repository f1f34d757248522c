#include "tests/support/allocation_count.hpp"

#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

namespace forcebound::test {
bool allocations_are_counted() noexcept { return false; }
std::uint64_t allocations() noexcept { return 0; }
}  // namespace forcebound::test

#else

namespace {
thread_local std::uint64_t count = 0;
}  // namespace

// glibc's own names for what we put ourselves in front of.
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t number, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) noexcept {
  ++count;
  return __libc_malloc(bytes);
}
void* calloc(std::size_t number, std::size_t bytes) noexcept {
  ++count;
  return __libc_calloc(number, bytes);
}
void* realloc(void* memory, std::size_t bytes) noexcept {
  ++count;
  return __libc_realloc(memory, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  ++count;
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept { return memalign(alignment, bytes); }
}

namespace forcebound::test {
bool allocations_are_counted() noexcept { return true; }
std::uint64_t allocations() noexcept { return count; }
}  // namespace forcebound::test

#endif
