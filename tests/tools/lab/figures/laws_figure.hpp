#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "forcebound/record/displayed_stiffness.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"
#include "tests/tools/lab/figures/envelope.hpp"

namespace forcebound::lab {

/// Runs of several laws over each other: penetration, force, passivity and displayed stiffness over time
/// (laws.gnuplot).
class LawsFigure {
 public:
  LawsFigure() = default;
  LawsFigure(std::string title, std::string subtitle) : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

  void set_title(std::string title, std::string subtitle) {
    title_ = std::move(title);
    subtitle_ = std::move(subtitle);
  }
  [[nodiscard]] const std::string& title() const noexcept { return title_; }
  [[nodiscard]] const std::string& subtitle() const noexcept { return subtitle_; }

  /// Adds a run, with time from its first tick; the sink stays valid as long as the figure.
  /// @param file tells runs of one law apart
  record::TickSink& add_run(const std::string& law, const std::string& file = {});

  /// run,time_s,penetration_mm,force_N,P_mJ,stiffness_N_per_mm: a row for each point of each run, which is named by
  /// its law, and by its file as well if there are several of that law.
  [[nodiscard]] std::string to_csv() const;

  /// @returns and throws as `draw` does.
  std::filesystem::path draw_to(const std::filesystem::path& png) const;

  /// A file's name from a title.
  [[nodiscard]] static std::string picture_name(const std::string& title);

 private:
  struct Curves final : record::TickSink {
    Curves(std::string of_law, std::string in_file) : law(std::move(of_law)), file(std::move(in_file)) {}
    void on_tick(const record::TickRecord& tick) noexcept override;
    void on_force(const record::ForceRecord&) noexcept override {}

    std::string law;
    std::string file;
    std::optional<record::Nanoseconds> start;
    record::DisplayedStiffness displayed{record::RunInfo{}.stiffness_depth_m_min};
    Envelope envelope{4};
  };

  [[nodiscard]] std::string name_of(const Curves& run) const;

  std::string title_;
  std::string subtitle_;
  std::deque<Curves> runs_;
};

}  // namespace forcebound::lab
