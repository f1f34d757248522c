#include <cstdarg>
#include <cstdio>

#include "forcebound/record/summary_view.hpp"

namespace forcebound::record {
namespace {

/// printf into the end of a string.
[[gnu::format(printf, 2, 3)]] void print(std::string& out, const char* format, ...) {
  char line[512];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  out += line;
}

void print_field(std::string& out, const char* name, const std::string& text) {
  if (text.empty()) return;
  print(out, "  %-13s ", name);
  out += text;  // of any length
  out += '\n';
}

std::string count_text(const std::optional<std::uint64_t>& count) { return count ? std::to_string(*count) : "?"; }

}  // namespace

void SummaryView::print_run(std::string& out) const {
  const RunInfo& info = s.info_;
  print(out, "Summary: law %.60s, %.1f s, %llu ticks\n", info.law.c_str(), duration_s(),
        static_cast<unsigned long long>(s.ticks_));
  print_field(out, "parameters", info.law_parameters);
  print_field(out, "device", info.facts.empty() ? info.device : info.facts);
  print_field(out, "operator", info.hand.empty() ? info.operator_name : info.hand);
  print_field(out, "scene", scene() + (simulated().empty() ? "" : ": " + simulated()));
  print_field(out, "network", info.network);
  print(out, "  period        %.1f us median, %.1f us p99, %.1f us p99.9, %.1f us max; %llu late by > 0.5 ms\n",
        s.period_ns_.percentile(0.5) * 1e-3, s.period_ns_.percentile(0.99) * 1e-3,
        s.period_ns_.percentile(0.999) * 1e-3, s.period_ns_.max() * 1e-3,
        static_cast<unsigned long long>(s.late_ticks_));
  if (const IdleTimer* idle = idle_timer()) {
    print(out,
          "  idle timer    %.1f us median, %.1f us p99, %.1f us p99.9, %.1f us max; %llu late: the machine's own\n",
          idle->p50_us, idle->p99_us, idle->p999_us, idle->max_us, static_cast<unsigned long long>(idle->late));
  }
}

void SummaryView::print_network(std::string& out) const {
  print(out, "  datagrams     %llu sent, %llu received, %s lost (%s up, %s down), %s duplicated, %s reordered\n",
        static_cast<unsigned long long>(sent()), static_cast<unsigned long long>(received()),
        count_text(lost()).c_str(), count_text(total(&RunTotals::lost_up)).c_str(),
        count_text(total(&RunTotals::lost_down)).c_str(), count_text(total(&RunTotals::duplicated)).c_str(),
        count_text(total(&RunTotals::reordered)).c_str());
  if (s.totals_) print_field(out, "motions", words_of(fates_of(*s.totals_)));
  if (s.forces_ == 0) {
    print(out, "  forces        none arrived\n");
    return;
  }
  print(out, "  force age     %.1f ms median, %.1f ms p99, %.1f ms max\n", s.age_ns_.percentile(0.5) * 1e-6,
        s.age_ns_.percentile(0.99) * 1e-6, s.age_ns_.max() * 1e-6);
  print(out, "  round trip    %.2f ms median, %.2f ms p99, %.2f ms max; server computes %.1f us median, %.1f us p99\n",
        s.round_trip_ns_.percentile(0.5) * 1e-6, s.round_trip_ns_.percentile(0.99) * 1e-6,
        s.round_trip_ns_.max() * 1e-6, s.compute_ns_.percentile(0.5) * 1e-3, s.compute_ns_.percentile(0.99) * 1e-3);
  print(out, "  late forces   %llu ticks faded, %llu ticks at zero, %llu changes; %llu blackouts, longest %.3f s\n",
        static_cast<unsigned long long>(s.fading_ticks_), static_cast<unsigned long long>(s.dropped_ticks_),
        static_cast<unsigned long long>(s.policy_changes_), static_cast<unsigned long long>(s.blackouts_),
        time::to_seconds(s.blackout_longest_));
}

void SummaryView::print_contact(std::string& out) const {
  if (s.contact_ticks_ == 0) {
    print(out, "  contact       none; %.3f N max\n", s.force_N_max_);
    return;
  }
  print(out, "  contact       %.1f %% of the ticks, penetration %.3f mm mean, %.3f mm max\n",
        100 * share(s.contact_ticks_), s.penetration_m_.mean() * 1e3, s.penetration_m_max_ * 1e3);
  print(out, "  force         %.3f N mean, %.4f N^2 variance in contact; %.3f N max; bounded on %.1f %% of the ticks\n",
        s.force_N_.mean(), s.force_N_.variance(), s.force_N_max_, 100 * bounded_fraction());
  print(out, "  stiffness     %.3f N/mm mean, %.3f N/mm median displayed\n", s.stiffness_.mean() * 1e-3,
        stiffness_median() * 1e-3);
}

void SummaryView::print_energy(std::string& out) const {
  if (s.info_.audited) {
    print(out, "  passivity     P minimum %.6g J, final %.6g J: %s\n", minimum_J(), final_J(),
          passive() ? "passive" : "NOT PASSIVE");
  } else {
    print(out, "  passivity     unknown: this device has no audit\n");
  }
  print(out, "  ledger        %.6g J left to spend\n", s.ledger_final_J_);
}

void SummaryView::print_faults(std::string& out) const {
  if (!s.totals_) {
    print(out, "  faults        unknown: the run was cut off before it counted them\n");
    return;
  }
  bool any = false;
  for (const Fault& fault : faults_of(*s.totals_)) {
    if (fault.count == 0) continue;
    print(out, "  %-13s %llu %s\n", any ? "" : "faults", static_cast<unsigned long long>(fault.count), fault.meaning);
    any = true;
  }
  for (const std::string& note : s.totals_->notes) {
    print_field(out, any ? "" : "faults", note);
    any = true;
  }
  if (!any) print(out, "  faults        none\n");
}

std::string Summary::to_text() const {
  const SummaryView view{*this};
  std::string out;
  view.print_run(out);
  view.print_network(out);
  view.print_contact(out);
  view.print_energy(out);
  view.print_faults(out);
  return out;
}

}  // namespace forcebound::record
