#include "forcebound/server/app/page_turn.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <iostream>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "forcebound/page/listen_address.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "forcebound/view/scene_parts.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::server {
namespace {

constexpr time::Nanoseconds kPeriod = std::chrono::milliseconds{500};
constexpr time::Nanoseconds kMovementPeriod = std::chrono::milliseconds{33};

std::vector<record::ScenePart> parts_of(const SceneLibrary& scenes, const std::string& name) {
  const auto scene = scenes.find(name);
  if (!scene) return {};
  return view::parts_of(view::shown(*scene, view::Which::all));
}

}  // namespace

PageTurn::PageTurn(const ProgramOptions& options, PageObserver& observer, const time::Clock& clock, LedRobot* robot,
                   const SceneLibrary& scenes, const std::string& scene)
    : observer_(observer),
      clock_(clock),
      robot_(robot),
      places_(options.server.sessions_max),
      page_(clock, {.recording = options.record,
                    .wall_clock = time::wall_clock_now() - clock.now(),
                    .parts_of = [scenes](const std::string& name) { return parts_of(scenes, name); },
                    .records = &observer.begin_records()}),
      log_([this](const std::string& level, const std::string& text) { page_.report(level, text); }),
      shown_(clock.now()) {
  const page::PageServer::Settings settings = page::page_settings(*options.page, text::program_path());
  if (const std::string why = page::missing_page(text::program_path()); !why.empty()) spdlog::warn("{}", why);
  if (robot_ != nullptr) page_.set_robot(robot_->appearance());
  page_.set_scene(scene);
  served_.emplace(settings, page_, page_.foxglove());
  std::cout << "page: " << page::printed_address(served_->address()) << std::endl;
}

void PageTurn::show_robot(time::Nanoseconds now) {
  if (robot_ == nullptr || now < next_movement_ || !page_.watched()) return;
  next_movement_ = now + kMovementPeriod;
  std::array<float, view::kNumbersMost> numbers{};
  for (std::size_t group = 0; group < robot_->appearance().moving.size(); ++group) {
    const std::size_t count = robot_->sample(group, numbers);
    if (count > 0) page_.move_robot(group, std::span(numbers).first(count));
  }
}

std::optional<std::uint64_t> PageTurn::session_of(std::uint64_t shown, ServerWorkers& server) const {
  const auto lock = server.observer_lock();
  return observer_.session_of(shown);
}

void PageTurn::turn(ServerWorkers& server) {
  const time::Nanoseconds now = clock_.now();
  show_robot(now);
  if (now < next_ && !page_.awaited()) return;
  next_ = now + kPeriod;
  while (const auto kick = page_.take_kick()) {
    const auto session = session_of(*kick, server);
    const bool ended = session && server.end_session(*session);  // which the log tells
    if (!ended) page_.report("warning", "session " + std::to_string(*kick) + " has ended already");
  }
  if (!page_.watched() && !page_.awaited()) return;
  const std::uint64_t motions = server.counters().motions_received;
  const double elapsed_s = time::to_seconds(now - shown_);
  const PageObserver::Load load{
      .busy = server.busy(),
      .motions_per_s = elapsed_s > 0 ? static_cast<double>(motions - motions_) / elapsed_s : 0,
      .places_used = server.sessions(),
      .places = places_};
  motions_ = motions;
  shown_ = now;
  try {
    const PageObserver::Snapshot seen = observer_.snapshot([&server] { return server.observer_lock(); });
    page_.show(seen.sessions_message(load), seen.metrics(load));
    if (!seen.sessions.empty()) page_.set_scene(seen.sessions.back().info.scene);  // of who came last
  } catch (const std::bad_alloc&) {  // the page shows what it had; serving goes on
  }
}

}  // namespace forcebound::server
