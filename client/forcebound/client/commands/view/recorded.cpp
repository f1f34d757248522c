#include "forcebound/client/commands/view/recorded.hpp"

#include <stdexcept>

#include "forcebound/record/recording_reader.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client::commands {
namespace {

class Collector final : public record::RecordingSink {
 public:
  explicit Collector(Recorded& to) : to_(to) {}

  void on_start(const record::RunInfo& info) override { to_.info = info; }
  void on_end(const record::RunTotals& totals) override { to_.totals = totals; }
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (to_.ticks.empty()) to_.degrees_of_freedom = static_cast<int>(tick.position.rows());
    if (full()) {
      left_out_ = true;
      return;
    }
    // Each tick is later than the one before, whatever the file says: what is played goes on.
    client::TickSample sample = sampler_.sample(tick);
    if (!to_.ticks.empty() && sample.time < to_.ticks.back().time) sample.time = to_.ticks.back().time;
    to_.ticks.push_back(sample);
  }
  void on_force(const record::ForceRecord& force) noexcept override {
    if (!full() && to_.forces.size() < Recorded::kTicksMost) to_.forces.push_back(sampler_.sample(force));
  }
  void on_motion(const record::MotionRecord& /*motion*/) override { of_server_ = true; }

  [[nodiscard]] bool left_out() const noexcept { return left_out_; }
  [[nodiscard]] bool of_server() const noexcept { return of_server_; }

 private:
  [[nodiscard]] bool full() const noexcept { return to_.ticks.size() >= Recorded::kTicksMost; }

  Recorded& to_;
  client::Sampler sampler_;
  bool left_out_ = false;
  bool of_server_ = false;
};

}  // namespace

double Recorded::duration_s() const noexcept { return time::to_seconds(ticks.back().time - ticks.front().time); }

const std::string& Recorded::scene() const noexcept {
  return totals && !totals->scene.empty() ? totals->scene : info.scene;
}

Recorded read_recorded(const std::filesystem::path& file) {
  Recorded recorded;
  Collector collector(recorded);
  const record::mcap::Ending ending = record::read_recording(file, collector);
  if (!ending) recorded.flaw = record::incomplete_in_words(file, ending);
  if (recorded.ticks.empty()) {
    throw std::runtime_error(file.string() + ": no message on topic /tick; a client's recording is needed" +
                             (collector.of_server() ? ", and this one is a server's" : ""));
  }
  if (collector.left_out()) {
    recorded.flaw = file.string() + ": shown are the first " + std::to_string(Recorded::kTicksMost) + " ticks of more";
  }
  return recorded;
}

}  // namespace forcebound::client::commands
