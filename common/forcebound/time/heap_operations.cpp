#include "forcebound/time/heap_operations.hpp"

#include <cerrno>
#include <cstddef>

namespace {

// In the program itself, so reading it allocates nothing.
thread_local std::uint64_t operations = 0;

}  // namespace

namespace forcebound::time {

std::uint64_t heap_operations_of_this_thread() noexcept { return operations; }

}  // namespace forcebound::time

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {

// glibc's own entry points for replacements of malloc.
// NOLINTBEGIN(readability-identifier-naming)
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
// NOLINTEND(readability-identifier-naming)

void* malloc(std::size_t size) {
  ++operations;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  ++operations;
  return __libc_calloc(count, size);
}

void* realloc(void* memory, std::size_t size) {
  ++operations;
  return __libc_realloc(memory, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++operations;
  return __libc_memalign(alignment, size);
}

void free(void* memory) {
  if (memory != nullptr) ++operations;  // Freeing a null pointer does not count: qsort does so.
  __libc_free(memory);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  ++operations;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

}  // extern "C"
#endif
