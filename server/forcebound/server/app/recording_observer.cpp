#include "forcebound/server/app/recording_observer.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <exception>
#include <utility>

#include "forcebound/view/scene_parts.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::server {
namespace {

constexpr std::chrono::milliseconds kDrainPeriod{100};

/// Empty: it is a scene that a program has added.
std::string shipped_text(const std::string& name) {
  try {
    return scene_source(name).text;
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace

RecordingObserver::RecordingObserver(const time::Clock& clock, const std::string& file, const record::RunInfo& info,
                                     Scenes scenes)
    : LogObserver(clock),
      clock_(clock),
      scenes_(std::move(scenes)),
      first_scene_(info.scene),
      file_(file),
      writer_(file, info),
      thread_([this](const std::stop_token& stopping) {
        while (!stopping.stop_requested()) {
          write_scenes();
          recorder_.drain(writer_);
          if (const std::string fault = watch_.take(recorder_, writer_); !fault.empty()) {
            spdlog::error("{}; the server goes on", fault);
          }
          std::this_thread::sleep_for(kDrainPeriod);
        }
      }) {
  queue_scene(first_scene_);
}

RecordingObserver::~RecordingObserver() { RecordingObserver::finish(); }

bool RecordingObserver::finish() {
  if (std::exchange(finished_, true)) return complete_;
  thread_.request_stop();
  thread_.join();
  write_scenes();
  recorder_.drain(writer_);
  writer_.flush();
  record::RunTotals totals;
  totals.recording_dropped = recorder_.dropped();
  totals.recording_unwritten = writer_.unwritten();
  if (!writer_.problem().empty()) totals.notes.push_back(writer_.problem());
  writer_.finish(totals);
  if (const auto missing = totals.recording_dropped + totals.recording_unwritten; missing > 0) {
    spdlog::error("{} records are missing in '{}' {}", missing, file_, writer_.problem());
  }
  complete_ = totals.recording_dropped + writer_.unwritten() == 0 && writer_.problem().empty();
  return complete_;
}

void RecordingObserver::on_opened(const SessionInfo& info) {
  LogObserver::on_opened(info);
  queue_scene(info.scene);
}

void RecordingObserver::queue_scene(const std::string& name) {
  if (!reported_.insert(name).second) return;
  UsedScene told{name, scenes_.library.find(name)};
  const std::scoped_lock lock(waiting_mutex_);
  waiting_.push_back(std::move(told));
}

void RecordingObserver::write_scenes() {
  std::vector<UsedScene> told;
  {
    const std::scoped_lock lock(waiting_mutex_);
    told.swap(waiting_);
  }
  for (const UsedScene& one : told) {
    const Nanoseconds now = clock_.now();
    if (one.scene) writer_.write_scene(view::parts_of(view::shown(*one.scene, view::Which::all)), now);
    const bool shipped = one.scene && !is_scene_file(one.name);
    std::string text = one.name == first_scene_ ? scenes_.text : std::string();
    if (text.empty() && shipped) text = shipped_text(one.name);
    if (text.empty()) continue;
    writer_.attach({.name = one.name + ".toml", .media_type = "application/toml", .content = std::move(text)}, now);
  }
}

void RecordingObserver::on_motion(const wire::MotionSample& motion) noexcept {
  recorder_.on_motion({.receive_time = clock_.now(), .motion = motion});
}

void RecordingObserver::on_force(const wire::EnvironmentForce& force) noexcept { recorder_.on_sent({.force = force}); }

}  // namespace forcebound::server
