#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

namespace forcebound::lab {

/// What a figure is drawn from.
struct Figure {
  std::string script;      ///< NAME.gnuplot of this folder, without the extension
  std::string csv;         ///< its data, as the script reads them
  std::string title{};     ///< empty: the script's own
  std::string subtitle{};  ///< the same
};

/// Draws with gnuplot. The data and the script are left beside the picture, FIGURE.csv and FIGURE.gnuplot, for whoever
/// wants to change it: `gnuplot FIGURE.gnuplot` in that folder draws it again.
///
/// @param png the picture, FIGURE.png
/// @returns the picture; without gnuplot the script, with a note on stderr
/// @throws std::runtime_error naming the file that cannot be written, or with gnuplot's error; the picture that was
/// there before stays then
std::filesystem::path draw(const Figure& figure, const std::filesystem::path& png);

/// Checks that drawing into `png` replaces none of these files. Empty names are no files.
/// @throws std::invalid_argument naming the file
void expect_apart(const std::filesystem::path& png, std::initializer_list<std::string> files);

/// A number of a figure's data: six significant digits, or "nan", which interrupts a curve.
[[nodiscard]] std::string figure_number(double value);

}  // namespace forcebound::lab
