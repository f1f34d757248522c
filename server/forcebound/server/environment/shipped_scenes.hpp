#pragma once

#include <span>

#include "forcebound/text/embedded_text.hpp"

namespace forcebound::server {

/// The files of server/scenes, by name.
[[nodiscard]] std::span<const text::EmbeddedText> shipped_scenes() noexcept;

}  // namespace forcebound::server
