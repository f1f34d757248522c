#include "tests/tools/lab/figure.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/label_placement.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::lab {
namespace {

constexpr int kWidth = 1400;
constexpr int kPanelHeight = 330;
constexpr int kHeadHeight = 84;
constexpr int kFootHeight = 66;
constexpr double kLeftShare = 0.085;
constexpr double kRightShare = 0.975;
constexpr const char* kInk = "#24292f";
constexpr const char* kGrid = "#e3e6ea";

void write_data(std::ostream& out, const Figure& figure) {
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const auto& all = figure.panels[p].series;
    for (std::size_t s = 0; s < all.size(); ++s) {
      out << "$data_" << p << '_' << s << " << EOD\n";
      for (std::size_t i = 0; i < all[s].x.size(); ++i) {
        if (std::isfinite(all[s].y[i])) {
          out << all[s].x[i] << ' ' << all[s].y[i] << '\n';
        } else {
          out << '\n';  // an empty line breaks the curve
        }
      }
      out << "EOD\n";
    }
  }
}

bool has_points(const Panel& panel) {
  for (const Series& series : panel.series) {
    for (const double y : series.y) {
      if (std::isfinite(y)) return true;
    }
  }
  return false;
}

/// A logarithmic axis has its numbers at every digit times a power of ten, or at 1, 2 and 5 times that where it is
/// longer than a decade, or at the powers alone where there are many of them: left to itself gnuplot puts none on an
/// axis of less than a decade, or makes it ten times as long.
struct LogAxis {
  double least = INFINITY;
  double most = 0;

  void add(const std::vector<double>& values) {
    for (const double value : values) {
      if (!std::isfinite(value) || !(value > 0)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  void widen() {
    // At least so long that it has some numbers.
    constexpr double kLeastLength = 3;
    const double length = most / least;
    const double room = std::max(std::pow(length, 0.04), std::sqrt(kLeastLength / length));
    least /= room;
    most *= room;
  }
  [[nodiscard]] std::string tics() const {
    const double length = most / least;
    const std::vector<double> digits = length > 1e3  ? std::vector<double>{1}
                                       : length > 10 ? std::vector<double>{1, 2, 5}
                                                     : std::vector<double>{1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9};
    const int first = static_cast<int>(std::floor(std::log10(least)));
    const int last = static_cast<int>(std::ceil(std::log10(most)));
    std::string tics;
    for (int power = first; power <= last; ++power) {
      for (const double digit : digits) {
        const double at = digit * std::pow(10.0, power);
        if (at < least || at > most) continue;
        tics += (tics.empty() ? "" : ",") + text::to_text(at);
      }
    }
    return tics;
  }
};

LogAxis log_y_axis(const Panel& panel) {
  LogAxis axis;
  for (const Series& series : panel.series) axis.add(series.y);
  if (!(axis.least <= axis.most)) axis = {0.1, 10};
  axis.widen();
  axis.least = panel.y_min.value_or(axis.least);
  axis.most = panel.y_max.value_or(axis.most);
  return axis;
}

void write_log_y_axis(std::ostream& out, const Panel& panel) {
  const LogAxis axis = log_y_axis(panel);
  out << "set logscale y\nset yrange [" << axis.least << ':' << axis.most << "]\nset ytics (" << axis.tics()
      << ")\nset ylabel " << gnuplot_string(panel.y_label) << " offset -1,0\n";
}

std::array<double, 2> ends_of(const Panel& panel) {
  double least = INFINITY;
  double most = -INFINITY;
  for (const Series& series : panel.series) {
    for (const double y : series.y) {
      if (!std::isfinite(y)) continue;
      least = std::min(least, y);
      most = std::max(most, y);
    }
  }
  for (const Reference& reference : panel.references) {
    least = std::min(least, reference.y);
    most = std::max(most, reference.y);
  }
  return least <= most ? std::array{least, most} : std::array{0.0, 1.0};
}

/// y = a asinh(.) is linear about zero and logarithmic far from it, on both sides.
void write_symmetric_y_axis(std::ostream& out, const Panel& panel) {
  const double unit = *panel.y_linear_to;
  const auto [least, most] = ends_of(panel);
  const double low = std::min(1.6 * least, -unit);
  const double high = std::max(1.6 * most, unit);
  std::string tics = "0";
  for (double at = unit; at <= std::max(-low, high); at *= 10) {
    if (at <= high) tics += "," + text::to_text(at);
    if (-at >= low) tics += "," + text::to_text(-at);
  }
  out << "set yrange [" << low << ':' << high << "]\nset nonlinear y via asinh(y/" << unit << ") inverse " << unit
      << "*sinh(y)\nset ytics (" << tics << ")\nset ylabel " << gnuplot_string(panel.y_label) << " offset -1,0\n";
}

void write_y_axis(std::ostream& out, const Panel& panel) {
  out << "unset nonlinear y\n";
  if (panel.y_log) return write_log_y_axis(out, panel);
  if (panel.y_linear_to) {
    out << "unset logscale y\n";
    return write_symmetric_y_axis(out, panel);
  }
  // An axis from a constant needs some height; '*' leaves the end to the data.
  out << "set yrange [";
  panel.y_min ? out << *panel.y_min : out << '*';
  out << ':';
  panel.y_max ? out << *panel.y_max : out << '*';
  out << "]\nset ylabel " << gnuplot_string(panel.y_label) << " offset -1,0\nunset logscale y\nset ytics autofreq\n";
}

std::string style_of(const Series& series) {
  std::ostringstream style;
  switch (series.mark) {
    case Series::Mark::none:
      style << "with lines linewidth " << series.width;
      break;
    case Series::Mark::dot:
      style << (series.joined ? "with linespoints" : "with points") << " pointtype 7 pointsize 0.9 linewidth "
            << series.width;
      break;
    case Series::Mark::ring:
      style << "with points pointtype 6 pointsize 2.4 linewidth 2.4";
      break;
    case Series::Mark::cross:
      style << "with points pointtype 2 pointsize 1.6 linewidth 2.4";
      break;
  }
  return style.str();
}

/// The panels share one x axis, so its ends are found here, not by gnuplot.
std::array<double, 2> x_range(const Figure& figure) {
  if (!figure.x_names.empty()) return {0.5, static_cast<double>(figure.x_names.size()) + 0.5};
  double least = INFINITY;
  double most = -INFINITY;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      for (const double x : series.x) {
        least = std::min(least, x);
        most = std::max(most, x);
      }
    }
  }
  if (!(least <= most)) return {0, 1};
  if (figure.x_log && least > 0) {
    LogAxis axis{least, most};
    axis.widen();
    return {axis.least, axis.most};
  }
  return least == most ? std::array{least, least + 1} : std::array{least, most};
}

void write_title(std::ostream& out, const Figure& figure, int height) {
  out << "set label 10 " << gnuplot_string(figure.title) << " at screen 0.5,screen " << 1 - 30.0 / height
      << " center font 'DejaVu Sans Bold,16' textcolor rgb '" << kInk << "'\nset label 11 "
      << gnuplot_string(figure.subtitle) << " at screen 0.5,screen " << 1 - 58.0 / height
      << " center font ',11' textcolor rgb '#57606a'\n";
}

/// The names of a panel's points, none upon another. The panel's y axis gets ends of its own, to know where its points
/// are.
void write_names(std::ostream& out, Panel& panel, const std::array<double, 2>& x_ends, bool x_log, double top,
                 double bottom, int height) {
  const bool named = std::ranges::any_of(panel.series, [](const Series& series) { return !series.names.empty(); });
  if (!named || panel.y_linear_to) return;
  std::array<double, 2> y_ends{};
  if (panel.y_log) {
    const LogAxis axis = log_y_axis(panel);
    y_ends = {axis.least, axis.most};
  } else {
    const auto [least, most] = ends_of(panel);
    const double room = most > least ? 0.08 * (most - least) : std::max(1e-6, 0.08 * std::abs(most));
    y_ends = {panel.y_min.value_or(least - room), panel.y_max.value_or(most + room)};
  }
  panel.y_min = y_ends[0];
  panel.y_max = y_ends[1];
  const auto share = [](double value, const std::array<double, 2>& ends, bool log) {
    return log ? std::log(value / ends[0]) / std::log(ends[1] / ends[0]) : (value - ends[0]) / (ends[1] - ends[0]);
  };
  const Box area{kLeftShare * kWidth, top, kWidth - 4, bottom};
  const double right = kRightShare * kWidth;
  std::vector<NamedPoint> points;
  for (const Series& series : panel.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!std::isfinite(series.y[i])) continue;
      points.push_back({area.left + share(series.x[i], x_ends, x_log) * (right - area.left),
                        bottom - share(series.y[i], y_ends, panel.y_log) * (bottom - top),
                        series.names.empty() ? "" : series.names[i]});
    }
  }
  int tag = 100;  // beyond those of titles
  for (const PlacedName& placed : place_names(points, area)) {
    const double middle_x = (placed.box.left + placed.box.right) / 2;
    const double middle_y = (placed.box.top + placed.box.bottom) / 2;
    out << "set label " << tag++ << ' ' << gnuplot_string(placed.name) << " at screen " << middle_x / kWidth
        << ", screen " << 1 - middle_y / height << " center font ',10' textcolor rgb '" << kInk << "' front\n";
    if (!placed.joined) continue;
    out << "set arrow from screen " << placed.x / kWidth << ", screen " << 1 - placed.y / height << " to screen "
        << std::clamp(placed.x, placed.box.left, placed.box.right) / kWidth << ", screen "
        << 1 - std::clamp(placed.y, placed.box.top, placed.box.bottom) / height
        << " nohead linewidth 0.8 linecolor rgb '#8a929a' back\n";
  }
}

void write_panel(std::ostream& out, const Figure& figure, std::size_t index, int height) {
  Panel panel = figure.panels[index];
  const auto y_of = [height](double pixels) { return 1 - pixels / height; };
  const double top = kHeadHeight + static_cast<double>(index) * kPanelHeight + 34;
  const double bottom = kHeadHeight + static_cast<double>(index + 1) * kPanelHeight - 30;
  out << "unset label\nunset arrow\n";
  if (index == 0) write_title(out, figure, height);
  write_names(out, panel, x_range(figure), figure.x_log, top, bottom, height);
  const bool last = index + 1 == figure.panels.size();
  out << "set tmargin at screen " << y_of(top) << "\nset bmargin at screen " << y_of(bottom) << '\n';
  out << "set label 1 " << gnuplot_string(panel.title)
      << " at graph 0,1 left offset 0,0.8 font 'DejaVu Sans Bold,12' textcolor rgb '" << kInk << "'\n";
  write_y_axis(out, panel);
  out << (last ? "set xlabel " + gnuplot_string(figure.x_label) : std::string("unset xlabel")) << '\n';
  if (!has_points(panel)) {
    out << "unset key\nset label 2 'no data' at graph 0.5,0.5 center textcolor rgb '#8a929a'\n"
        << "set yrange [0:1]\nplot nothing notitle\n";
    return;
  }
  out << "set key at graph 1,1.03 right bottom horizontal maxrows 1 Left reverse samplen 2 spacing 1 textcolor rgb '"
      << kInk << "'\n";
  const char* separator = "plot ";
  for (const Reference& reference : panel.references) {
    out << separator << reference.y << " with lines dashtype 2 linewidth 1.5 linecolor rgb '" << colour::kDanger
        << "' title " << gnuplot_string(reference.label);
    separator = ", ";
  }
  for (std::size_t s = 0; s < panel.series.size(); ++s) {
    const Series& series = panel.series[s];
    if (series.x.empty()) continue;
    out << separator << "$data_" << index << '_' << s << " using 1:2 " << style_of(series) << " linecolor rgb '"
        << series.colour << "' " << (series.label.empty() ? "notitle" : "title " + gnuplot_string(series.label));
    separator = ", ";
  }
  out << '\n';
}

std::string x_tics(const Figure& figure, double least, double most) {
  if (figure.x_log) return "set logscale x\nset xtics (" + LogAxis{least, most}.tics() + ")\n";
  if (figure.x_names.empty()) return {};
  std::string tics;
  for (std::size_t i = 0; i < figure.x_names.size(); ++i) {
    tics += (i == 0 ? "" : ", ") + gnuplot_string(figure.x_names[i]) + " " + std::to_string(i + 1);
  }
  return "set xtics (" + tics + ")\n";
}

std::string script_of(const Figure& figure, const std::filesystem::path& png) {
  const int height = kHeadHeight + kFootHeight - 30 + kPanelHeight * static_cast<int>(figure.panels.size());
  const auto [x_least, x_most] = x_range(figure);
  std::ostringstream out;
  out.precision(12);
  out << "set encoding utf8\nset terminal pngcairo noenhanced rounded size " << kWidth << ',' << height
      << " font 'DejaVu Sans,12' background rgb '#ffffff'\nset output " << gnuplot_string(png.string()) << '\n';
  write_data(out, figure);
  out << "set multiplot\n"
      << "set lmargin at screen " << kLeftShare << "\nset rmargin at screen " << kRightShare << "\n"
      << "set border 3 linecolor rgb '#8a929a'\nset tics nomirror out scale 0.6 textcolor rgb '" << kInk << "'\n"
      << "set offsets 0, 0, graph 0.06, graph 0.03\nset grid xtics ytics back linetype 1 linewidth 1 linecolor rgb '"
      << kGrid << "'\n"
      << "set format y '%g'\nset xrange [" << x_least << ':' << x_most << "]\n"
      << x_tics(figure, x_least, x_most) << "nothing = NaN\n";
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    write_panel(out, figure, p, height);
  }
  out << "unset multiplot\nset output\n";
  return out.str();
}

}  // namespace

std::string gnuplot_string(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += '\'';
    out += c == '\n' ? ' ' : c;
  }
  return out + "'";
}

const char* colour::of_law(const std::string& law) {
  if (law == "none") return kDanger;
  if (law == "fba-less") return kNetwork;
  if (law == "fba-more") return kApplied;
  if (law == "fba-exact") return kAudit;
  // The baseline laws: quieter, and no two of a kind.
  static const std::map<std::string, const char*, std::less<>> kBaselines{
      {"aol", "#c9a227"},  {"eba", "#5f6b76"},        {"mbpa", "#8c6d46"}, {"pspm", "#4b9da9"}, {"sfa", "#b5838d"},
      {"tdpa", "#7b4fa3"}, {"tdpa-2port", "#a98bc9"}, {"tla", "#6a994e"},  {"vc", "#e07a5f"},   {"wave", "#3d405b"}};
  const auto baseline = kBaselines.find(law);
  return baseline == kBaselines.end() ? kLedger : baseline->second;
}

void cut_spikes(Panel& panel, double usual_most, double most) {
  constexpr double kRoom = 1.5;
  if (!(usual_most > 0) || most <= kRoom * usual_most) return;
  panel.y_max = kRoom * usual_most;
  panel.title += " (spikes cut off)";
}

void draw(const Figure& figure, const std::filesystem::path& png) { draw_script(script_of(figure, png), png); }

void draw_script(const std::string& script, const std::filesystem::path& png) {
  const test::TemporaryFolder directory;
  const auto file = directory.path() / "figure.gnuplot";
  std::ofstream(file) << script;
  const std::string command = "gnuplot '" + file.string() + "' 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start gnuplot");
  std::string said;
  std::array<char, 512> part{};
  while (std::fgets(part.data(), static_cast<int>(part.size()), pipe) != nullptr) said += part.data();
  const int status = ::pclose(pipe);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {
    throw std::runtime_error(
        "gnuplot is needed to draw figures and is not installed (Debian: apt-get install gnuplot-nox)");
  }
  std::error_code ignored;
  if (status != 0 || std::filesystem::file_size(png, ignored) == 0 || ignored) {
    for (char& c : said) {
      if (c == '\n') c = ' ';
    }
    throw std::runtime_error("gnuplot could not draw '" + png.string() + "': " + said);
  }
}

}  // namespace forcebound::lab
