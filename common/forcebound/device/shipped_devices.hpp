#pragma once

#include <span>

#include "forcebound/text/embedded_text.hpp"

namespace forcebound::device {

/// The files of common/devices, by name.
[[nodiscard]] std::span<const text::EmbeddedText> shipped_devices() noexcept;

}  // namespace forcebound::device
