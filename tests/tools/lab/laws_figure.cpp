#include "tests/tools/lab/laws_figure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace forcebound::lab {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSmallEnergy_mJ = 1;

std::string file_name(const std::string& title) {
  std::string name;
  for (const char c : title) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  return name + ".png";
}

}  // namespace

void LawsFigure::Curves::on_tick(const record::TickRecord& tick) noexcept {
  if (!start) start = tick.time;
  const double t = time::to_seconds(tick.time - *start);
  penetration_mm.add(t, tick.penetration_m > 0 ? tick.penetration_m * 1e3 : kNone);
  force_N.add(t, tick.applied.norm());
  audit_mJ.add(t, tick.audit_J * 1e3);
  const auto shown_N_per_m = displayed.on_tick(tick);
  stiffness_N_per_mm.add(t, shown_N_per_m ? 1e-3 * *shown_N_per_m : kNone);
  if (shown_N_per_m) stiffness_mN_per_mm.add(time::from_seconds(1e-9 * *shown_N_per_m).count());  // saturating
}

record::TickSink& LawsFigure::add_law(const std::string& law) { return laws_.emplace_back(law); }

void LawsFigure::draw_to(const std::filesystem::path& png) const {
  Panel penetration{.title = "Penetration", .y_label = "penetration [mm]", .y_min = 0};
  Panel force{.title = "Force on the device", .y_label = "magnitude [N]", .y_min = 0};
  // A law that is not passive returns a thousand times the energy of the others: on a linear scale these would be a
  // line at zero.
  Panel passivity{.title = "Passivity: energy taken less returned; logarithmic beyond 1 mJ",
                  .y_label = "P [mJ]",
                  .references = {{0, "passive above"}},
                  .y_linear_to = kSmallEnergy_mJ};
  Panel stiffness{
      .title = "Displayed stiffness at rest (depth changes by less than 5 mm/s)", .y_label = "K [N/mm]", .y_min = 0};
  double usual_N_per_mm = 0;
  double most_N_per_mm = 0;
  for (const Curves& curves : laws_) {
    const char* hue = colour::of_law(curves.law);
    penetration.series.push_back(curves.penetration_mm.series(curves.law, hue));
    force.series.push_back(curves.force_N.series(curves.law, hue));
    passivity.series.push_back(curves.audit_mJ.series(curves.law, hue));
    stiffness.series.push_back(curves.stiffness_N_per_mm.series(curves.law, hue));
    usual_N_per_mm = std::max(usual_N_per_mm, 1e-3 * curves.stiffness_mN_per_mm.percentile(0.95));
    most_N_per_mm = std::max(most_N_per_mm, 1e-3 * static_cast<double>(curves.stiffness_mN_per_mm.max()));
  }
  cut_spikes(stiffness, usual_N_per_mm, most_N_per_mm);
  Figure figure{.title = title_, .subtitle = subtitle_, .panels = {}};
  figure.panels = {std::move(penetration), std::move(force), std::move(passivity), std::move(stiffness)};
  draw(figure, png);
}

std::filesystem::path LawsFigure::draw_into(const std::filesystem::path& directory) const {
  std::filesystem::create_directories(directory);
  const auto png = directory / file_name(title_);
  draw_to(png);
  return png;
}

}  // namespace forcebound::lab
