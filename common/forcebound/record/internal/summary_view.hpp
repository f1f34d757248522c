#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "forcebound/record/summary.hpp"

namespace forcebound::record {

/// Gives the printers access to a summary's fields; private to this folder.
struct SummaryView {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static constexpr double kPassiveLeast_J = -1e-9;  // rounding error allowed in a sum of energies

  const Summary& s;

  [[nodiscard]] double duration_s() const { return time::to_seconds(s.last_ - s.first_); }
  [[nodiscard]] double minimum_J() const { return s.info_.audited ? s.passivity_minimum_J_ : kNone; }
  [[nodiscard]] double final_J() const { return s.info_.audited ? s.passivity_final_J_ : kNone; }

  enum class Verdict : std::uint8_t { passive, not_passive, not_audited, no_contact, never_connected };
  [[nodiscard]] Verdict verdict() const;
  [[nodiscard]] bool touched() const { return s.contact_ticks_ > 0 || s.force_N_max_ > 0; }
  [[nodiscard]] bool recording_incomplete() const {
    return s.totals_ && s.totals_->recording_dropped + s.totals_->recording_unwritten > 0;
  }
  [[nodiscard]] double bounded_fraction() const { return share(s.bounded_ticks_); }
  [[nodiscard]] double share(std::uint64_t ticks) const {
    return s.ticks_ == 0 ? kNone : static_cast<double>(ticks) / static_cast<double>(s.ticks_);
  }
  [[nodiscard]] std::uint64_t stale_ticks() const { return s.fading_ticks_ + s.dropped_ticks_; }
  [[nodiscard]] double rest_fraction() const {
    return s.settled_ticks_ == 0 ? kNone : static_cast<double>(s.rest_ticks_) / static_cast<double>(s.settled_ticks_);
  }
  [[nodiscard]] double rest_force_N() const { return s.rest_uN_.percentile(0.5) * 1e-6; }
  [[nodiscard]] double rest_depth_m() const { return s.rest_nm_.percentile(0.5) * 1e-9; }
  [[nodiscard]] double stiffness_median() const { return s.stiffness_mN_per_m_.percentile(0.5) * 1e-3; }

  /// A count of the session, if the run ended properly.
  [[nodiscard]] std::optional<std::uint64_t> total(std::uint64_t RunTotals::*count) const {
    return s.totals_ ? std::optional((*s.totals_).*count) : std::nullopt;
  }
  [[nodiscard]] std::uint64_t sent() const { return total(&RunTotals::sent).value_or(s.sent_); }
  [[nodiscard]] std::uint64_t received() const { return total(&RunTotals::received).value_or(s.forces_); }
  [[nodiscard]] std::optional<std::uint64_t> lost() const {
    return s.totals_ ? std::optional(s.totals_->lost_up + s.totals_->lost_down) : std::nullopt;
  }

  /// The scene as the server named it, else as requested.
  [[nodiscard]] const std::string& scene() const {
    return s.totals_ && !s.totals_->scene.empty() ? s.totals_->scene : s.info_.scene;
  }
  [[nodiscard]] const std::string& simulated() const {
    return s.totals_ && !s.totals_->simulated.empty() ? s.totals_->simulated : s.info_.simulated;
  }

  /// Null where it was not measured.
  [[nodiscard]] const IdleTimer* idle_timer() const {
    return s.totals_ && s.totals_->idle_timer.wake_ups > 0 ? &s.totals_->idle_timer : nullptr;
  }

  [[nodiscard]] nlohmann::ordered_json motions() const;
  [[nodiscard]] nlohmann::ordered_json blackouts() const;
  [[nodiscard]] nlohmann::ordered_json server_clock() const;
  [[nodiscard]] nlohmann::ordered_json follower() const;

  void add_run(nlohmann::ordered_json& json) const;
  void add_network(nlohmann::ordered_json& json) const;
  void add_times(nlohmann::ordered_json& json) const;
  void add_contact(nlohmann::ordered_json& json) const;
  void add_faults(nlohmann::ordered_json& json) const;

  void print_verdict(std::string& out, text::Colour colour) const;
  void print_run(std::string& out) const;
  void print_network(std::string& out) const;
  void print_rendering(std::string& out) const;
  void print_follower(std::string& out) const;
  void print_contact(std::string& out) const;
  void print_energy(std::string& out, text::Colour colour) const;
  void print_faults(std::string& out) const;
};

}  // namespace forcebound::record
