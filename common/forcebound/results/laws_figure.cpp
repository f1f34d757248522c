#include "forcebound/results/laws_figure.hpp"

#include <array>
#include <limits>

#include "forcebound/results/figure_scripts.hpp"
#include "forcebound/text/table.hpp"

namespace forcebound::results {
namespace {

constexpr double kNoContact = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void LawsFigure::Curves::on_tick(const record::TickRecord& tick) noexcept {
  if (!start) start = tick.time;
  envelope.add(time::to_seconds(tick.time - *start),
               std::array{tick.applied.norm(), tick.penetration_m > 0 ? 1e3 * tick.penetration_m : kNoContact,
                          1e3 * tick.audit_J});
}

record::TickSink& LawsFigure::add_run(const std::string& law, const std::string& heading) {
  return runs_.emplace_back(law, heading);
}

std::string LawsFigure::to_csv() const {
  text::Table table({{"run"}, {"law"}, {"time_s"}, {"force_N"}, {"penetration_mm"}, {"P_mJ"}});
  for (const Curves& curves : runs_) {
    for (const auto& [time_s, y] : curves.envelope.points()) {
      table.add({curves.heading, curves.law, figure_number(time_s), figure_number(y[0]), figure_number(y[1]),
                 figure_number(y[2])});
    }
  }
  return table.to_csv();
}

std::filesystem::path LawsFigure::draw_to(const std::filesystem::path& png, const Formats& formats) const {
  return draw(
      {.script = text::text_of(figure_scripts(), "laws"), .csv = to_csv(), .title = title_, .subtitle = subtitle_}, png,
      formats);
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

}  // namespace forcebound::results
