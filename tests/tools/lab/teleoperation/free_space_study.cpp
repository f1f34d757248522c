#include "tests/tools/lab/teleoperation/free_space_study.hpp"

#include <algorithm>
#include <complex>
#include <memory>
#include <stdexcept>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"

namespace forcebound::lab {
namespace {

constexpr double kLeave_s = 1;     // at rest until then
constexpr double kHasten_s = 0.5;  // until it has its speed
constexpr double kSettle_s = 0.5;  // of the robot, beyond the network's delay
constexpr double kMeasure_s = 0.5;

/// At rest, then at one speed.
class LeadingHand final : public device::Operator {
 public:
  explicit LeadingHand(const Eigen::Vector3d& velocity_m_per_s) : velocity_(velocity_m_per_s) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "leading"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return 3; }
  [[nodiscard]] Target target(double time_s) const noexcept override {
    const double gone_s = std::max(0.0, time_s - kLeave_s);
    const double hasten_s = std::min(gone_s, kHasten_s);
    Target target;
    target.position = (hasten_s * hasten_s / (2 * kHasten_s) + gone_s - hasten_s) * velocity_;
    target.velocity = hasten_s / kHasten_s * velocity_;
    return target;
  }
  [[nodiscard]] std::string description() const override { return "leading"; }

 private:
  device::Hand hand_ = ScriptOperator::Settings{}.hand;
  Eigen::Vector3d velocity_;
};

class FreeSpace {
 public:
  FreeSpace(const TeleoperationStudy& study, const std::string& architecture, const std::string& law,
            const NamedNetwork& network)
      : setup_(setup_of(study, "stiff-wall", architecture, law, network, 1)),
        row_{.architecture = architecture,
             .law = law,
             .network = network.name,
             .delay_s = time::to_seconds(network.settings.up.delay.mean)} {}

  FreeSpaceRow measure() {
    for (std::size_t swing = 0; swing < kFreeSwings_m.size(); ++swing) {
      for (std::size_t i = 0; i < kSwings_Hz.size(); ++i) {
        const SwingOutcome outcome =
            swing_hand(setup_, {.size_m = kFreeSwings_m[swing], .frequency_Hz = kSwings_Hz[i]});
        row_.felt_N_s_per_m[swing][i] = std::abs(outcome.met.N_s_per_m);
        add(outcome.measures);
      }
    }
    for (std::size_t i = 0; i < kLeaderSpeeds_m_per_s.size(); ++i) row_.lag_m[i] = lag_m(kLeaderSpeeds_m_per_s[i]);
    return row_;
  }

 private:
  double lag_m(double speed_m_per_s) {
    const Eigen::Vector3d way = Eigen::Vector3d::UnitY();
    const server::WorkspaceSettings& workspace = setup_.follower.workspace;
    const Eigen::Vector3d velocity = speed_m_per_s / workspace.motion_scale * workspace.rotation.transpose() * way;
    TeleoperationSetup setup = setup_;
    setup.make_hand = [=] { return std::make_unique<LeadingHand>(velocity); };
    const double settled_s = kLeave_s + kHasten_s + kSettle_s + row_.delay_s;
    setup.duration_s = settled_s + kMeasure_s;
    std::vector<TeleoperationMoment> moments;
    add(run_teleoperation(setup, &moments));
    double most_m = 0;
    for (const TeleoperationMoment& now : moments) {
      if (now.time_s >= settled_s) most_m = std::max(most_m, (now.leader_m - now.tool_m).dot(way));
    }
    return most_m - row_.delay_s * speed_m_per_s;
  }

  void add(const TeleoperationMeasures& measures) {
    if (measures.peak_N > 0) {
      throw std::runtime_error("free space: the tool touched something with " + text::rounded(measures.peak_N) +
                               " N; a smaller --motion-scale keeps it away");
    }
    row_.least_P_J = std::min({row_.least_P_J, measures.leader_minimum_J, measures.follower_minimum_J});
  }

  TeleoperationSetup setup_;
  FreeSpaceRow row_;
};

/// Marks what misses its bound, and counts both.
class Bounds {
 public:
  std::string cell(double value, const std::string& words, double most, bool is_bounded) {
    if (!is_bounded) return words;
    ++bounded_;
    if (value <= most) return words;
    ++missed_;
    return words + "!";
  }
  [[nodiscard]] std::string words() const {
    return std::to_string(missed_) + " of " + std::to_string(bounded_) + " figures with a bound miss it";
  }

 private:
  int bounded_ = 0;
  int missed_ = 0;
};

}  // namespace

std::vector<NamedNetwork> free_space_networks() {
  return {network_of("none"), network_of("delay 20ms"), network_of("delay 50ms"), network_of("delay 100ms"),
          network_of("delay 400ms")};
}

std::vector<FreeSpaceRow> study_free_space(const TeleoperationStudy& study) {
  for (const NamedNetwork& network : study.networks) {
    if (!network.settings.trace) continue;
    throw std::invalid_argument("free space is measured at a known delay: expected none or netem's words, got '" +
                                network.name + "'");
  }
  std::vector<FreeSpaceRow> rows;
  for (const NamedNetwork& network : study.networks) {
    for (const std::string& architecture : study.architectures) {
      for (const std::string& law : study.laws) rows.push_back(FreeSpace(study, architecture, law, network).measure());
    }
  }
  return rows;
}

std::string free_space_text(const std::vector<FreeSpaceRow>& rows) {
  std::vector<text::Table::Column> columns{{"architecture, law"}};
  for (const double swing_m : kFreeSwings_m) {
    for (const double frequency_Hz : kSwings_Hz) {
      columns.push_back({text::rounded(frequency_Hz) + " Hz", text::fixed(1e3 * swing_m, 0) + " mm"});
    }
  }
  for (const double speed : kLeaderSpeeds_m_per_s) columns.push_back({"lag at " + text::fixed(1e3 * speed, 0), "mm"});
  columns.push_back({"least P", "mJ"});
  text::Table table(columns);
  Bounds bounds;
  std::string heading;
  for (const FreeSpaceRow& row : rows) {
    if (const std::string now = results::network_in_words(row.network); now != heading)
      table.add_heading(heading = now);
    std::vector<text::Table::Cell> cells{row.architecture + ", " + row.law};
    const bool nearby = row.delay_s < kNearby_s + 1e-6;
    for (const auto& felt : row.felt_N_s_per_m) {
      for (std::size_t i = 0; i < felt.size(); ++i) {
        cells.emplace_back(
            bounds.cell(felt[i], text::fixed(felt[i], 1), kFeltMost_N_s_per_m, nearby && kSwings_Hz[i] <= kSlow_Hz));
      }
    }
    for (const double lag_m : row.lag_m) {
      cells.emplace_back(bounds.cell(lag_m, text::fixed(1e3 * lag_m, 1), kLagMost_m, nearby));
    }
    cells.emplace_back(results::millijoules(row.least_P_J));
    table.add(cells);
  }
  return table.to_text() +
         "\n  Hz      force on a hand that swings so far to each side and so often over its speed\n"
         "          [N s/m], in whatever phase (--impedance): what it feels beyond its device\n"
         "  lag at  most of the way from the tool to a leader of so many mm/s, less delay times speed\n"
         "  !       beyond " +
         text::rounded(kFeltMost_N_s_per_m) + " N s/m up to " + text::rounded(kSlow_Hz) + " Hz, or " +
         text::rounded(1e3 * kLagMost_m) + " mm, through up to " + text::rounded(1e3 * kNearby_s) +
         " ms: " + bounds.words() + "\n";
}

}  // namespace forcebound::lab
