#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace forcebound::results {

/// What a figure is drawn from.
struct Figure {
  std::string_view script;  ///< gnuplot's, which goes on after figures/style.gnuplot; outlives the figure
  std::string csv;          ///< its data, with the columns that the script reads
  std::string title{};      ///< empty: the script's own
  std::string subtitle{};   ///< the same
};

/// What a figure may be drawn as beside PNG, for a paper: "pdf", "svg".
using Formats = std::vector<std::string>;

/// Draws with gnuplot. The data and the script are left beside the picture, FIGURE.csv and FIGURE.gnuplot, for whoever
/// wants to change it: `gnuplot FIGURE.gnuplot` in that folder draws it again.
///
/// @param png the picture, FIGURE.png
/// @param formats the same picture as FIGURE.FORMAT too
/// @returns the picture; without gnuplot the script, with a note on stderr
/// @throws std::runtime_error naming the file that cannot be written, or with gnuplot's error; the picture that was
/// there before stays then
std::filesystem::path draw(const Figure& figure, const std::filesystem::path& png, const Formats& formats = {});

/// Checks before long work that the pictures, their data and script can be written, and replace neither one of these
/// files nor any data and script but those of an earlier figure. Empty names are no files.
/// @throws std::invalid_argument naming the one of `files`, std::runtime_error naming any other
void expect_drawable(const std::filesystem::path& png, const std::vector<std::string>& files,
                     const Formats& formats = {});

/// Data as gnuplot reads them: it ends a field at a comma even between quotes, and an item of a list at a quote. A
/// comma and a line's end within a field become a blank, a quote becomes '.
[[nodiscard]] std::string readable_by_gnuplot(std::string_view csv);

/// A number of a figure's data: six significant digits, or "nan", which interrupts a curve.
[[nodiscard]] std::string figure_number(double value);

}  // namespace forcebound::results
