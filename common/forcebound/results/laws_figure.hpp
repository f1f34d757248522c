#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "forcebound/record/tick_record.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/envelope.hpp"

namespace forcebound::results {

/// Runs of several laws side by side: force, depth and passivity over time (laws.gnuplot).
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
  /// @param heading of its column; no other run may have it
  record::TickSink& add_run(const std::string& law, const std::string& heading);
  /// Adds what is felt without a network, which is drawn behind the runs of that law.
  record::TickSink& add_reference(const std::string& law) { return add_run(law, {}); }

  /// run,law,time_s,force_N,penetration_mm,P_mJ: a row for each point of each run, by its heading; a reference has
  /// none.
  [[nodiscard]] std::string to_csv() const;

  /// @returns and throws as `draw` does.
  std::filesystem::path draw_to(const std::filesystem::path& png, const Formats& formats = {}) const;

  /// A file's name from a title.
  [[nodiscard]] static std::string picture_name(const std::string& title);

 private:
  struct Curves final : record::TickSink {
    Curves(std::string of_law, std::string below) : law(std::move(of_law)), heading(std::move(below)) {}
    void on_tick(const record::TickRecord& tick) noexcept override;

    std::string law;
    std::string heading;
    std::optional<record::Nanoseconds> start;
    Envelope envelope{3};
  };

  std::string title_;
  std::string subtitle_;
  std::deque<Curves> runs_;
};

}  // namespace forcebound::results
