#include "forcebound/client/session/outage_detector.hpp"

#include <algorithm>

namespace forcebound::client {
namespace {

std::uint64_t difference(std::uint64_t more, std::uint64_t less) noexcept { return more > less ? more - less : 0; }

/// `own`: the share of each count that the reporting message itself adds.
void count(const Progress& before, const Progress& after, std::uint64_t own, record::Blackout& blackout) noexcept {
  const auto between = [&](std::uint64_t Progress::*counter) {
    return difference(difference(after.*counter, before.*counter), own);
  };
  blackout.counted = true;
  blackout.motions = between(&Progress::motions_made);
  blackout.lost_up = difference(blackout.motions, between(&Progress::motions_arrived));
  blackout.answers = between(&Progress::answers_sent);
  blackout.lost_down = difference(blackout.answers, between(&Progress::answers_arrived));
}

}  // namespace

void OutageDetector::on_force(Nanoseconds now, const Progress& progress) noexcept {
  if (in_blackout(now)) {
    present_.duration = now - last_->time;
    present_.over = true;
    if (progress.session == last_->progress.session) count(last_->progress, progress, 1, present_);
    if (present_.duration > longest_.duration) longest_ = present_;
  }
  last_ = {now, progress};
  present_ = {};
}

void OutageDetector::on_bye(Nanoseconds now, const Progress& progress, Bye kind) noexcept {
  if (!last_ || progress.session != last_->progress.session) return;
  present_.server_left = kind == Bye::of_the_server;
  // Without a blackout before it, datagrams still on their way would be counted as lost.
  if (in_blackout(now)) count(last_->progress, progress, 0, present_);
}

record::Blackout OutageDetector::longest(Nanoseconds now) const noexcept {
  if (!in_blackout(now) || now - last_->time <= longest_.duration) return longest_;
  record::Blackout blackout = present_;
  blackout.duration = now - last_->time;
  return blackout;
}

}  // namespace forcebound::client
