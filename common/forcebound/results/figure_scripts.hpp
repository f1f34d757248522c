#pragma once

#include <span>

#include "forcebound/text/embedded_text.hpp"

namespace forcebound::results {

/// The gnuplot scripts of the folder figures, by name.
[[nodiscard]] std::span<const text::EmbeddedText> figure_scripts() noexcept;

}  // namespace forcebound::results
