#pragma once

#include <span>

#include "forcebound/text/embedded_text.hpp"

namespace forcebound::server {

/// The MJCF files of server/robots, by name.
[[nodiscard]] std::span<const text::EmbeddedText> shipped_robots() noexcept;

}  // namespace forcebound::server
