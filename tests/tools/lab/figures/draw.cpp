#include "tests/tools/lab/figures/draw.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <string_view>

#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/figures/scripts.hpp"

namespace forcebound::lab {
namespace {

std::string_view embedded_script(std::string_view name) {
  const auto scripts = figure_scripts();
  const auto script = std::ranges::find(scripts, name, &text::EmbeddedText::name);
  if (script == scripts.end()) throw std::logic_error("there is no script '" + std::string(name) + ".gnuplot'");
  return script->text;
}

/// In single quotes, in which `quote` stands for a quote.
std::string quoted(std::string_view text, std::string_view quote) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += quote;
    } else {
      out += c == '\n' ? ' ' : c;
    }
  }
  return out + "'";
}

std::string script_of(const Figure& figure, const std::string& name) {
  const auto gnuplot_string = [](std::string_view text) { return quoted(text, "''"); };
  return "# Draws a figure of forcebound-lab from the CSV file beside it.\nname = " + gnuplot_string(name) +
         "\ntitle = " + gnuplot_string(figure.title) + "\nsubtitle = " + gnuplot_string(figure.subtitle) + "\n\n" +
         std::string(embedded_script("style")) + '\n' + std::string(embedded_script(figure.script));
}

struct GnuplotResult {
  int status;
  std::string said;
};

GnuplotResult run_gnuplot(const std::filesystem::path& script) {
  const std::filesystem::path folder = script.has_parent_path() ? script.parent_path() : ".";
  const auto shell_word = [](const std::filesystem::path& path) { return quoted(path.string(), "'\\''"); };
  const std::string command =
      "cd -- " + shell_word(folder) + " && gnuplot " + shell_word("./" + script.filename().string()) + " 2>&1";
  FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start a shell for gnuplot");
  GnuplotResult result{};
  std::array<char, 512> part{};
  while (std::fgets(part.data(), static_cast<int>(part.size()), pipe) != nullptr) result.said += part.data();
  result.status = ::pclose(pipe);
  return result;
}

}  // namespace

std::filesystem::path draw(const Figure& figure, const std::filesystem::path& png) {
  constexpr int kCommandNotFound = 127;
  const auto script = std::filesystem::path(png).replace_extension(".gnuplot");
  text::write_file(std::filesystem::path(png).replace_extension(".csv"), figure.csv);
  text::write_file(script, script_of(figure, png.stem().string()));
  text::write_file(png, "");
  GnuplotResult result = run_gnuplot(script);
  if (WIFEXITED(result.status) && WEXITSTATUS(result.status) == kCommandNotFound) {
    std::filesystem::remove(png);
    std::cerr << "note: " << png.string() << " is not drawn, since gnuplot is not installed (Debian: apt-get install "
              << "gnuplot-nox); its data and script are there: gnuplot " << script.string() << '\n';
    return script;
  }
  if (result.status != 0 || std::filesystem::file_size(png) == 0) {
    std::ranges::replace(result.said, '\n', ' ');
    throw std::runtime_error("gnuplot could not draw '" + png.string() + "': " + result.said);
  }
  std::cerr << result.said;  // its warnings
  return png;
}

std::string figure_number(double value) { return std::isfinite(value) ? text::rounded(value, 6) : "nan"; }

}  // namespace forcebound::lab
