#pragma once

#include <filesystem>
#include <string>

namespace forcebound::lab {

/// What a figure is drawn from.
struct Figure {
  std::string script;      ///< NAME.gnuplot of this folder, without the extension
  std::string csv;         ///< its data; the script's head says which columns
  std::string title{};     ///< empty: the script's own
  std::string subtitle{};  ///< the same
};

/// Draws with gnuplot. The data and the script are left beside the picture, FIGURE.csv and FIGURE.gnuplot, for whoever
/// wants to change it: `gnuplot FIGURE.gnuplot` in that folder draws it again.
///
/// @param png the picture, FIGURE.png
/// @returns the picture; without gnuplot, which is said on stderr, the script
/// @throws std::runtime_error naming the file that cannot be written, or saying what gnuplot said
std::filesystem::path draw(const Figure& figure, const std::filesystem::path& png);

/// A number of a figure's data: six significant digits, or "nan", which interrupts a curve.
[[nodiscard]] std::string figure_number(double value);

}  // namespace forcebound::lab
