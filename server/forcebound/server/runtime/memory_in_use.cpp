#include "forcebound/server/runtime/memory_in_use.hpp"

#include <unistd.h>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace forcebound::server {

std::size_t memory_in_use() noexcept {
#if defined(__GLIBC__)
  const struct mallinfo2 info = ::mallinfo2();
  // In arenas, and in mappings of their own.
  return info.uordblks + info.hblkhd;
#else
  return 0;
#endif
}

std::size_t memory_of_machine() noexcept {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page_bytes <= 0) return 0;
  return static_cast<std::size_t>(pages) * static_cast<std::size_t>(page_bytes);
}

}  // namespace forcebound::server
