#include <algorithm>
#include <string>

#include "forcebound/record/internal/summary_view.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::record {
namespace {

using text::counted;

constexpr std::size_t kNameColumns = 16;
constexpr int kDigits = 4;

std::string rounded(double value) { return text::rounded(value, kDigits); }

std::string millijoules(double energy_J) { return rounded(1e3 * energy_J) + " mJ"; }

std::string percent(double share) { return text::rounded(100 * share) + " %"; }

/// A line "  name          words", continued below the words where it is too long; nothing without words.
void print_field(std::string& out, const char* name, const std::string& words) {
  if (words.empty()) return;
  std::string line = "  " + std::string(name);
  line.resize(std::max(line.size() + 1, kNameColumns), ' ');
  out += text::wrapped(line + text::printable(words), kNameColumns) + '\n';
}

std::string count_text(const std::optional<std::uint64_t>& count) { return count ? std::to_string(*count) : "?"; }

std::string percentiles(const Histogram& ns, double unit_ns, const char* unit) {
  return rounded(ns.percentile(0.5) / unit_ns) + " " + unit + " median, " + rounded(ns.percentile(0.99) / unit_ns) +
         " p99";
}

}  // namespace

void SummaryView::print_verdict(std::string& out, text::Colour colour) const {
  switch (verdict()) {
    case Verdict::passive:
      out += "passive";
      break;
    case Verdict::not_passive:
      out += text::red("NOT PASSIVE", colour);
      break;
    case Verdict::not_audited:
      out += "not audited";
      break;
    case Verdict::no_contact:
      out += "no contact, no verdict";
      break;
    case Verdict::never_connected:
      out += "never connected, no verdict";
      break;
  }
  if (recording_incomplete()) out += ", " + text::red("RECORDING INCOMPLETE", colour);
}

void SummaryView::print_run(std::string& out) const {
  const RunInfo& info = s.info_;
  print_field(out, "law", info.law + (info.law_parameters.empty() ? "" : ": " + info.law_parameters));
  const std::string& device = info.facts.empty() ? info.device : info.facts;
  print_field(out, "device", (info.device_simulated ? "simulated, " : "") + device);
  print_field(out, "operator", info.hand.empty() ? info.operator_name : info.hand);
  print_field(out, "scene", scene() + (simulated().empty() ? "" : ": " + simulated()));
  print_field(out, "network", info.network);
  print_field(out, "encryption", info.encryption);
  if (s.ticks_ < 2) return;
  print_field(out, "period",
              percentiles(s.period_ns_, 1e3, "us") + ", " + rounded(s.period_ns_.percentile(0.999) * 1e-3) +
                  " p99.9, " + rounded(s.period_ns_.max() * 1e-3) + " max; " + std::to_string(s.late_ticks_) + " late");
  if (const IdleTimer* idle = idle_timer()) {
    print_field(out, "idle timer",
                rounded(idle->p50_us) + " us median, " + rounded(idle->p99_us) + " p99, " + rounded(idle->p999_us) +
                    " p99.9, " + rounded(idle->max_us) + " max; " + std::to_string(idle->late) + " late");
  }
}

void SummaryView::print_network(std::string& out) const {
  print_field(out, "datagrams",
              std::to_string(sent()) + " sent, " + std::to_string(received()) + " received, " + count_text(lost()) +
                  " lost (" + count_text(total(&RunTotals::lost_up)) + " up, " +
                  count_text(total(&RunTotals::lost_down)) + " down), " + count_text(total(&RunTotals::duplicated)) +
                  " duplicated, " + count_text(total(&RunTotals::reordered)) + " reordered");
  if (s.totals_) print_field(out, "motions", words_of(fates_of(*s.totals_)));
  if (s.forces_ == 0) {
    print_field(out, "forces", "none arrived");
    return;
  }
  print_field(out, "force age",
              s.age_ns_.count() == 0
                  ? "no tick had a force"
                  : percentiles(s.age_ns_, 1e6, "ms") + ", " + rounded(s.age_ns_.max() * 1e-6) + " max");
  print_field(out, "round trip",
              percentiles(s.round_trip_ns_, 1e6, "ms") + ", " + rounded(s.round_trip_ns_.max() * 1e-6) +
                  " max; server " + rounded(s.compute_ns_.percentile(0.5) * 1e-3) + " us, " +
                  rounded(s.compute_ns_.percentile(0.99) * 1e-3) + " p99");
  print_field(out, "late forces",
              counted(s.fading_ticks_, "tick") + " faded, " + std::to_string(s.dropped_ticks_) + " at zero, " +
                  counted(s.policy_changes_, "change") + "; " + counted(s.blackouts_, "blackout") +
                  (s.blackouts_ == 0 ? "" : ", longest " + rounded(time::to_seconds(s.blackout_longest_)) + " s"));
}

void SummaryView::print_rendering(std::string& out) const {
  if (s.info_.rendering != "local") {
    print_field(out, "rendering", s.info_.rendering + ": all forces are the server's");
    return;
  }
  std::string words = "local: " + percent(share(s.at_client_ticks_)) + " of the ticks at the client, " +
                      percent(share(s.both_ticks_)) + " both, " +
                      percent(share(s.ticks_ - s.at_client_ticks_ - s.both_ticks_)) + " held";
  const bool trusted = s.model_trust_.count() > 0;
  if (trusted || s.modelled_ticks_ > 0) words += "; local models on " + percent(share(s.modelled_ticks_));
  if (trusted) words += ", trust in them " + percent(s.model_trust_.mean());
  if (const auto pieces = total(&RunTotals::scene_pieces); pieces.value_or(0) > 0) {
    words += "; scene in " + counted(*pieces, "piece") + ", " +
             rounded(static_cast<double>(s.totals_->scene_piece_bytes) * 1e-3) + " kB";
  } else if (total(&RunTotals::scenes_from_cache).value_or(0) > 0) {
    words += "; scene from the cache";
  }
  print_field(out, "rendering", words);
}

void SummaryView::print_follower(std::string& out) const {
  if (!s.has_follower_) return;
  std::string words;
  for (std::uint8_t i = 1; i < control::kFollowerStates; ++i) {
    const Nanoseconds time = s.follower_times_.at(i);
    if (time == Nanoseconds{0}) continue;
    words += (words.empty() ? "" : ", ") + std::string(control::name_of(static_cast<control::FollowerState>(i))) + " " +
             rounded(time::to_seconds(time)) + " s";
  }
  if (s.follower_unknown_ > Nanoseconds{0}) {
    words += ", not known for " + rounded(time::to_seconds(s.follower_unknown_)) + " s without answers";
  }
  print_field(
      out, "robot",
      words + "; " + counted(s.follower_changes_, "change") + ", last " + std::string(control::name_of(s.follower_)));
}

void SummaryView::print_contact(std::string& out) const {
  if (s.shows_torque_) print_field(out, "torque", rounded(s.torque_N_m_max_) + " N m max");
  if (s.contact_ticks_ == 0) {
    print_field(out, "contact",
                (s.has_follower_ ? "not told by a robot; " : "none; ") + rounded(s.force_N_max_) + " N max");
    return;
  }
  std::string contact = percent(share(s.contact_ticks_)) + " of the ticks, ";
  if (s.penetration_m_.count() > 0) {
    contact += rounded(s.penetration_m_.mean() * 1e3) + " mm deep in the mean, " + rounded(s.penetration_m_max_ * 1e3) +
               " at most";
  } else {
    contact += "depth not known";
  }
  if (s.unknown_ticks_ > 0 && !s.info_.surface_true) {
    contact += "; surface not known on " + percent(share(s.unknown_ticks_)) +
               " of the ticks, where the newest answer is for a place over 1 mm away";
  }
  print_field(out, "contact", contact);
  print_field(out, "force",
              rounded(s.force_N_.mean()) + " N mean, " + rounded(s.force_N_.variance()) + " N^2 variance in contact; " +
                  rounded(s.force_N_max_) + " N max; bounded on " + percent(bounded_fraction()));
  const double speed_mm_per_s = 1e3 * DisplayedStiffness::kSpeed_m_per_s;
  if (s.rest_ticks_ == 0) {
    print_field(out, "at rest",
                "never: the depth, where it is known, never changed by less than " + rounded(speed_mm_per_s) + " mm/s");
    return;
  }
  print_field(out, "at rest",
              percent(rest_fraction()) + " of the contact (depth changes by less than " + rounded(speed_mm_per_s) +
                  " mm/s); medians there: " + rounded(rest_force_N()) + " N, " + rounded(rest_depth_m() * 1e3) +
                  " mm deep, " +
                  (s.stiffness_.count() == 0
                       ? "too shallow for a stiffness"
                       : rounded(stiffness_median()) + " N/m displayed against " +
                             (s.info_.surface_true ? "the true surface" : "the plane of the newest answer")));
}

void SummaryView::print_energy(std::string& out, text::Colour colour) const {
  if (s.info_.audited) {
    const std::string minimum = millijoules(minimum_J());
    // Colour codes take no columns, so they are inserted after the line is broken.
    std::string line;
    print_field(line, "passivity", "least P " + minimum + ", final " + millijoules(final_J()));
    const std::size_t at = line.find(minimum);
    if (verdict() == Verdict::not_passive && at != std::string::npos) {
      line.replace(at, minimum.size(), text::red(minimum, colour));
    }
    out += line;
  } else {
    print_field(
        out, "passivity",
        "not audited: this device does not measure P. Law " + s.info_.law +
            (s.info_.guarantee.empty() ? " guarantees nothing about it." : " guarantees " + s.info_.guarantee + "."));
  }
  print_field(out, "ledger", millijoules(s.ledger_final_J_) + " left to spend");
}

void SummaryView::print_faults(std::string& out) const {
  if (!s.totals_) {
    print_field(out, "faults", "unknown: the recording ends before the totals");
    return;
  }
  bool any = false;
  for (const Fault& fault : faults_of(*s.totals_)) {
    if (fault.count == 0) continue;
    print_field(out, any ? "" : "faults", std::to_string(fault.count) + " " + fault.meaning());
    any = true;
  }
  for (const std::string& note : s.totals_->notes) {
    print_field(out, any ? "" : "faults", note);
    any = true;
  }
  if (!any) print_field(out, "faults", "none");
}

bool Summary::not_passive() const { return SummaryView{*this}.verdict() == SummaryView::Verdict::not_passive; }

bool Summary::recording_incomplete() const { return SummaryView{*this}.recording_incomplete(); }

std::string Summary::to_text(text::Colour colour) const {
  const SummaryView view{*this};
  std::string out = "Summary: ";
  view.print_verdict(out, colour);
  out += "; " + rounded(view.duration_s()) + " s, " + counted(ticks_, "tick") + '\n';
  view.print_run(out);
  view.print_network(out);
  view.print_rendering(out);
  view.print_follower(out);
  view.print_contact(out);
  view.print_energy(out, colour);
  view.print_faults(out);
  return out;
}

}  // namespace forcebound::record
