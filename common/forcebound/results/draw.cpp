#include "forcebound/results/draw.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "forcebound/results/figure_scripts.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::results {
namespace {

// What draws `png` writes beside it.
constexpr std::string_view kFirstLine = "# Draws a figure of Forcebound from the CSV file beside it.";
std::filesystem::path data_of(std::filesystem::path png) { return png.replace_extension(".csv"); }
std::filesystem::path script_of(std::filesystem::path png) { return png.replace_extension(".gnuplot"); }

/// The picture in every format, PNG first.
std::vector<std::filesystem::path> pictures_of(const std::filesystem::path& png, const Formats& formats) {
  std::vector<std::filesystem::path> pictures{png};
  for (const std::string& format : formats) pictures.push_back(std::filesystem::path(png).replace_extension(format));
  return pictures;
}

/// Puts a file aside as long as another may take its place.
class SetAside {
 public:
  explicit SetAside(const std::filesystem::path& file) : file_(file), aside_(file.string() + ".before") {
    std::error_code ignored;
    if (std::filesystem::exists(file_, ignored)) std::filesystem::rename(file_, aside_);
  }
  ~SetAside() {
    std::error_code ignored;
    if (kept_) {
      std::filesystem::remove(aside_, ignored);
    } else {
      std::filesystem::remove(file_, ignored);
      std::filesystem::rename(aside_, file_, ignored);
    }
  }
  SetAside(const SetAside&) = delete;
  SetAside& operator=(const SetAside&) = delete;
  SetAside(SetAside&&) = delete;
  SetAside& operator=(SetAside&&) = delete;

  void keep_the_new() noexcept { kept_ = true; }

 private:
  std::filesystem::path file_;
  std::filesystem::path aside_;
  bool kept_ = false;
};

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

std::string script_text(const Figure& figure, const std::string& name) {
  const auto gnuplot_string = [](std::string_view text) { return quoted(text::printable_lines(text), "''"); };
  return std::string(kFirstLine) + "\nname = " + gnuplot_string(name) + "\ntitle = " + gnuplot_string(figure.title) +
         "\nsubtitle = " + gnuplot_string(figure.subtitle) + "\n\n" +
         std::string(text::text_of(figure_scripts(), "style")) + '\n' + std::string(figure.script);
}

[[noreturn]] void refuse_to_replace(const std::filesystem::path& file, const std::filesystem::path& png) {
  throw std::runtime_error(file.string() + ": would be replaced by data or script of the figure " + png.string() +
                           ", but is not of an earlier one: move it, or draw elsewhere");
}

struct GnuplotResult {
  int status;
  std::string output;
};

/// @param format "png", "pdf" or "svg"
GnuplotResult run_gnuplot(const std::filesystem::path& script, const std::string& format) {
  const std::filesystem::path folder = script.has_parent_path() ? script.parent_path() : ".";
  const auto shell_word = [](const std::filesystem::path& path) { return quoted(path.string(), "'\\''"); };
  const std::string command = "cd -- " + shell_word(folder) + " && gnuplot -d -e \"format = '" + format + "'\" " +
                              shell_word("./" + script.filename().string()) + " 2>&1";
  FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start a shell for gnuplot");
  GnuplotResult result{};
  std::array<char, 512> part{};
  while (std::fgets(part.data(), static_cast<int>(part.size()), pipe) != nullptr) result.output += part.data();
  result.status = ::pclose(pipe);
  return result;
}

/// @returns false without gnuplot
bool draw_picture(const std::filesystem::path& picture) {
  constexpr int kCommandNotFound = 127;
  SetAside before(picture);
  GnuplotResult result = run_gnuplot(script_of(picture), picture.extension().string().substr(1));
  if (WIFEXITED(result.status) && WEXITSTATUS(result.status) == kCommandNotFound) return false;
  std::error_code ignored;
  const bool drawn = std::filesystem::exists(picture, ignored) && std::filesystem::file_size(picture, ignored) > 0;
  if (result.status != 0 || !drawn) {
    std::ranges::replace(result.output, '\n', ' ');
    throw std::runtime_error("gnuplot could not draw '" + picture.string() + "': " + result.output);
  }
  before.keep_the_new();
  std::cerr << text::printable_lines(result.output);  // its warnings
  return true;
}

}  // namespace

std::filesystem::path draw(const Figure& figure, const std::filesystem::path& png, const Formats& formats) {
  const auto script = script_of(png);
  text::write_file(script.string(), script_text(figure, png.stem().string()));
  text::write_file(data_of(png).string(), readable_by_gnuplot(figure.csv));
  if (std::ranges::all_of(pictures_of(png, formats), draw_picture)) return png;
  std::cerr << "note: " << png.string() << " is not drawn, since gnuplot is not installed (Debian: apt-get install "
            << "gnuplot-nox); its data and script are there: gnuplot " << script.string() << '\n';
  return script;
}

void expect_drawable(const std::filesystem::path& png, const std::vector<std::string>& files, const Formats& formats) {
  auto all_written = pictures_of(png, formats);
  all_written.push_back(data_of(png));
  all_written.push_back(script_of(png));
  for (const auto& written : all_written) {
    for (const std::string& file : files) {
      if (file.empty() || !text::is_same_path(file, written)) continue;
      throw std::invalid_argument("the figure " + png.string() + " would replace " + file +
                                  ": its data and script go beside it; give one of them another name");
    }
    text::expect_writable(written.string());
  }
  std::error_code ignored;
  if (const auto script = script_of(png); std::filesystem::exists(script, ignored)) {
    if (!text::read_file(script.string()).starts_with(kFirstLine)) refuse_to_replace(script, png);
  } else if (std::filesystem::exists(data_of(png), ignored)) {
    refuse_to_replace(data_of(png), png);
  }
}

std::string readable_by_gnuplot(std::string_view csv) {
  std::string readable;
  readable.reserve(csv.size());
  bool within = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    const char c = csv[i];
    if (c == '"') {
      const bool is_text = within && i + 1 < csv.size() && csv[i + 1] == '"';
      if (is_text) {
        readable += '\'';
        ++i;
      } else {
        within = !within;
      }
    } else if (within && (c == ',' || c == '\n')) {
      const bool blank_follows = i + 1 < csv.size() && csv[i + 1] == ' ';
      if (!blank_follows) readable += ' ';
    } else {
      readable += c;
    }
  }
  return readable;
}

std::string figure_number(double value) { return std::isfinite(value) ? text::rounded(value, 6) : "nan"; }

}  // namespace forcebound::results
