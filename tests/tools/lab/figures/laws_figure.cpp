#include "tests/tools/lab/figures/laws_figure.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "forcebound/text/table.hpp"
#include "tests/tools/lab/figures/draw.hpp"

namespace forcebound::lab {
namespace {

constexpr double kNoContact = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void LawsFigure::Curves::on_tick(const record::TickRecord& tick) noexcept {
  if (!start) start = tick.time;
  const auto stiffness_N_per_m = displayed.on_tick(tick);
  envelope.add(time::to_seconds(tick.time - *start),
               std::array{tick.penetration_m > 0 ? 1e3 * tick.penetration_m : kNoContact, tick.applied.norm(),
                          1e3 * tick.audit_J, stiffness_N_per_m ? 1e-3 * *stiffness_N_per_m : kNoContact});
}

record::TickSink& LawsFigure::add_run(const std::string& law, const std::string& file) {
  return runs_.emplace_back(law, file);
}

std::string LawsFigure::name_of(const Curves& run) const {
  const bool alone = std::ranges::count(runs_, run.law, &Curves::law) == 1;
  return alone ? run.law : run.law + " " + run.file;
}

std::string LawsFigure::to_csv() const {
  text::Table table({{"run"}, {"time_s"}, {"penetration_mm"}, {"force_N"}, {"P_mJ"}, {"stiffness_N_per_mm"}});
  for (const Curves& curves : runs_) {
    const std::string name = name_of(curves);
    for (const auto& [time_s, y] : curves.envelope.points()) {
      table.add({name, figure_number(time_s), figure_number(y[0]), figure_number(y[1]), figure_number(y[2]),
                 figure_number(y[3])});
    }
  }
  return table.to_csv();
}

std::filesystem::path LawsFigure::draw_to(const std::filesystem::path& png) const {
  return draw({.script = "laws", .csv = to_csv(), .title = title_, .subtitle = subtitle_}, png);
}

std::string LawsFigure::picture_name(const std::string& title) {
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

}  // namespace forcebound::lab
