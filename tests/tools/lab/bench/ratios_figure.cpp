#include "tests/tools/lab/bench/ratios_figure.hpp"

#include <algorithm>
#include <sstream>

#include "tests/tools/lab/figure.hpp"

namespace forcebound::lab {
namespace {

constexpr int kRatiosWidth = 1400;
constexpr int kBarHeight = 44;
constexpr int kRatiosHeadHeight = 150;
constexpr double kHalfBar = 0.32;

std::vector<BenchRow> ratios_of(const BenchResults& results) {
  std::vector<BenchRow> rows;
  for (const BenchRow& row : results.rows) {
    if (row.kind == BenchRow::Kind::ratio) rows.push_back(row);
  }
  return rows;
}

void write_bars(std::ostream& out, const std::vector<BenchRow>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const char* hue = !rows[i].fine() ? colour::kDanger : rows[i].wanted.empty() ? colour::kApplied : colour::kAudit;
    const double y = -static_cast<double>(i);
    out << "set object rectangle from 1," << y - kHalfBar << " to " << rows[i].ratio << ',' << y + kHalfBar
        << " fillcolor rgb '" << hue << "' fillstyle solid noborder\n"
        << "set label " << gnuplot_string(rows[i].ratio) << " at " << std::max(1.0, std::stod(rows[i].ratio)) << ','
        << y << " offset 0.8,0 textcolor rgb '" << hue << "'\n";
    if (rows[i].wanted.size() < 4) continue;
    const std::string bound = rows[i].wanted.substr(3);
    out << "set arrow from " << bound << ',' << y - 0.45 << " to " << bound << ',' << y + 0.45
        << " nohead linewidth 2 dashtype 2 linecolor rgb '" << colour::kDanger << "' front\n";
  }
}

}  // namespace

void draw_ratios(const BenchResults& results, const std::filesystem::path& png) {
  const std::vector<BenchRow> rows = ratios_of(results);
  std::ostringstream out;
  out << "set encoding utf8\nset terminal pngcairo noenhanced rounded size " << kRatiosWidth << ','
      << kRatiosHeadHeight + kBarHeight * static_cast<int>(rows.size())
      << " font 'DejaVu Sans,12' background rgb '#ffffff'\nset output " << gnuplot_string(png.string()) << '\n'
      << "set label 'Ratio of ours to the reference; dashed: required bound' at screen 0.5,screen 0.95 center "
         "font 'DejaVu Sans Bold,16'\nset tmargin 4\n"
      << "set logscale x\nset border 1 linecolor rgb '#8a929a'\nset tics nomirror out scale 0.6 textcolor rgb "
         "'#24292f'\nset lmargin 62\n"
      << "set rmargin 6\nset grid xtics linetype 1 linecolor rgb '#e3e6ea'\nunset key\nset xlabel 'ratio'\n"
      << "set yrange [" << -static_cast<double>(rows.size()) + 0.4 << ":0.6]\nset xrange [0.1:*]\nset ytics (";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out << (i > 0 ? ", " : "")
        << gnuplot_string(rows[i].what + (rows[i].conditions.empty() ? "" : " (" + rows[i].conditions + ")") + " / " +
                          rows[i].yardstick)
        << ' ' << -static_cast<double>(i);
  }
  out << ")\n$data << EOD\n1 0\n";
  for (std::size_t i = 0; i < rows.size(); ++i) out << rows[i].ratio << ' ' << -static_cast<double>(i) << '\n';
  out << "EOD\n";
  write_bars(out, rows);
  out << "set arrow from 1,graph 0 to 1,graph 1 nohead linewidth 1.5 linecolor rgb '#24292f'\n"
      << "plot $data using 1:2 with points pointtype 0 notitle\nset output\n";
  draw_script(out.str(), png);
}

}  // namespace forcebound::lab
