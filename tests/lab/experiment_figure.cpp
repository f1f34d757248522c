#include "tests/lab/experiment_figure.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace forcebound::lab {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kDepthLeast_m = 1e-5;

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

void ExperimentFigure::Curves::on_tick(const record::TickRecord& tick) noexcept {
  const double t = time::to_seconds(tick.time);
  const bool contact = tick.penetration_m > 0;
  const bool deep = tick.penetration_m > kDepthLeast_m;
  penetration_mm.add(t, contact ? tick.penetration_m * 1e3 : kNone);
  force_N.add(t, tick.applied.norm());
  audit_mJ.add(t, tick.audit_J * 1e3);
  stiffness_N_per_mm.add(t, deep ? tick.displayed_N / tick.penetration_m * 1e-3 : kNone);
}

record::TickSink& ExperimentFigure::add_law(const std::string& law) { return laws_.emplace_back(law); }

std::filesystem::path ExperimentFigure::draw_into(const std::filesystem::path& directory) const {
  Figure figure{.title = title_, .subtitle = "same device, same hand, three laws", .panels = {}};
  Panel penetration{.title = "How deep the hand gets in", .y_label = "penetration [mm]"};
  Panel force{.title = "Force on the device", .y_label = "|f| [N]"};
  Panel energy{.title = "Passivity audit: below zero the device gave energy to the hand", .y_label = "P [mJ]"};
  Panel stiffness{.title = "Displayed stiffness", .y_label = "K [N/mm]"};
  energy.references = {{0, ""}};
  for (const Curves& curves : laws_) {
    const char* hue = colour::of_law(curves.law);
    penetration.series.push_back(curves.penetration_mm.series(curves.law, hue));
    force.series.push_back(curves.force_N.series(curves.law, hue));
    energy.series.push_back(curves.audit_mJ.series(curves.law, hue));
    stiffness.series.push_back(curves.stiffness_N_per_mm.series(curves.law, hue));
  }
  figure.panels = {std::move(penetration), std::move(force), std::move(energy), std::move(stiffness)};
  std::filesystem::create_directories(directory);
  const auto png = directory / file_name(title_);
  draw(figure, png);
  return png;
}

}  // namespace forcebound::lab
