#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace forcebound::security {

/// RFC 4648, with padding.
[[nodiscard]] std::string base64_of(std::span<const std::byte> bytes);

}  // namespace forcebound::security
