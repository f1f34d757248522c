#pragma once

#include <span>

#include "forcebound/text/embedded_text.hpp"

namespace forcebound::server {

/// The files of server/tasks, by name.
[[nodiscard]] std::span<const text::EmbeddedText> shipped_tasks() noexcept;

}  // namespace forcebound::server
