#include "tests/support/allocation_guard.hpp"

#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FORCEBOUND_SANITIZER_OWNS_MALLOC
#endif

namespace {
thread_local std::uint64_t heap_operations_of_thread = 0;
}

#ifndef FORCEBOUND_SANITIZER_OWNS_MALLOC

// glibc's own names for what we put ourselves in front of.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  ++heap_operations_of_thread;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  ++heap_operations_of_thread;
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  ++heap_operations_of_thread;
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  ++heap_operations_of_thread;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  *result = memalign(alignment, size);
  return *result ? 0 : ENOMEM;
}

void free(void* memory) {
  heap_operations_of_thread += memory != nullptr;
  __libc_free(memory);
}
}

#endif

namespace forcebound::tests {

AllocationGuard::AllocationGuard() noexcept : before_(heap_operations_of_thread) {}

std::uint64_t AllocationGuard::heap_operations() const noexcept { return heap_operations_of_thread - before_; }

bool AllocationGuard::counts() noexcept {
#ifdef FORCEBOUND_SANITIZER_OWNS_MALLOC
  return false;
#else
  return true;
#endif
}

}  // namespace forcebound::tests
