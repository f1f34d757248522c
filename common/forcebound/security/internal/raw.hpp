#pragma once

#include <cstddef>
#include <type_traits>

namespace forcebound::security {

/// Bytes as libsodium takes them.
template <class Bytes>
[[nodiscard]] auto* raw(Bytes&& bytes) noexcept {
  auto* const first = bytes.data();
  static_assert(std::is_same_v<std::remove_const_t<std::remove_pointer_t<decltype(bytes.data())>>, std::byte>);
  if constexpr (std::is_const_v<std::remove_pointer_t<decltype(bytes.data())>>) {
    return reinterpret_cast<const unsigned char*>(first);
  } else {
    return reinterpret_cast<unsigned char*>(first);
  }
}

}  // namespace forcebound::security
