#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace forcebound::wire {

/// What people at both ends are told when client and server speak different versions of the protocol:
///
///     the server speaks protocol version 1, the client version 2: update the server
///
/// The end with the smaller version is the one to update. Real time: noexcept, no allocation.
class VersionMismatch {
 public:
  VersionMismatch(std::uint32_t server, std::uint32_t client) noexcept;

  [[nodiscard]] std::string_view text() const noexcept { return {text_.data(), bytes_}; }

 private:
  std::array<char, 128> text_{};
  std::size_t bytes_ = 0;
};

}  // namespace forcebound::wire
