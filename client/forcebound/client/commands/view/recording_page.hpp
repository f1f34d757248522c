#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/commands/view/recorded.hpp"
#include "forcebound/client/page/page_state.hpp"
#include "forcebound/client/page/run_figures.hpp"
#include "forcebound/page/subject.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client::commands {

/// Plays a recording on a live page, to all viewers the same: with its time on a slider, and at another speed.
class RecordingPage final : public page::Subject {
 public:
  /// Of the past, sent with each jump [s].
  static constexpr double kPast_s = 10;

  /// @param file the recording's name, for people. @param scene the message `scene`. @param clock must outlive it
  RecordingPage(Recorded recorded, const std::string& file, std::string scene, const time::Clock& clock);

  void greet(page::ViewerId viewer, page::Viewers& viewers) override;
  void receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) override;
  void beat(page::Viewers& viewers) override;
  [[nodiscard]] std::string metrics() override;

 private:
  /// Figures after so many ticks and answers, to begin from.
  struct Checkpoint {
    client::RunFigures figures;
    std::size_t tick = 0;
    std::size_t force = 0;
  };

  void mark_checkpoints();
  void collect_events();
  [[nodiscard]] double time_s(std::size_t tick) const noexcept;
  [[nodiscard]] std::size_t tick_at(double time_s) const noexcept;
  void act_on(const page::Request& request, page::ViewerId viewer, page::Viewers& viewers);
  void play(bool on, double speed, page::Viewers& viewers);
  /// Up to this tick, exclusively.
  void go_on_to(std::size_t tick);
  void jump(double to_s, page::Viewers& viewers);
  void send_ticks(page::Viewers& viewers);
  void send_hello(page::Viewers& viewers) const;

  Recorded recorded_;
  std::string scene_;
  const time::Clock& clock_;
  client::PageState state_;
  std::vector<Checkpoint> checkpoints_;
  std::vector<std::string> events_;
  Checkpoint now_;
  double now_s_ = 0;
  std::optional<double> jump_to_s_{0};
  std::uint64_t beats_ = 0;
  std::uint64_t jumped_ = 0;  // at which beat
  time::Nanoseconds last_beat_;
};

}  // namespace forcebound::client::commands
