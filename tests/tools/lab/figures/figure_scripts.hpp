#pragma once

#include <span>

#include "forcebound/text/embedded_text.hpp"

namespace forcebound::lab {

/// The gnuplot scripts of this folder, by name, for results::Figure.
[[nodiscard]] std::span<const text::EmbeddedText> figure_scripts() noexcept;

}  // namespace forcebound::lab
