#pragma once

#include <span>

#include "forcebound/text/embedded_text.hpp"

namespace forcebound::client {

/// The scene files that a server of this version ships, by name.
[[nodiscard]] std::span<const text::EmbeddedText> scene_files() noexcept;

}  // namespace forcebound::client
