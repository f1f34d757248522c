#include "forcebound/server/session/scene_sender.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kUnknownRoundTrip = 300ms;
constexpr double kPatience = 1.3;  // round trips
constexpr Nanoseconds kLeastPatience = 10ms;
// How far ahead the device is looked for: so many round trips of its way, and no further than a hand goes.
constexpr double kAhead = 0.8;
constexpr double kAheadMost_m = 0.2;
// Of the device's velocity: one step of an encoder in 1 ms would look like 20 mm/s.
constexpr double kSmooth_s = 8e-3;
constexpr double kMoved_m = 2e-3;
// Of a frame with a piece in it, and IP and UDP about it.
constexpr double kPieceOnTheWire = 1180;

time::TokenBucket bucket(const HandoverRate& rate, Nanoseconds now) {
  return {time::from_seconds(kPieceOnTheWire / std::max(1e3, rate.bytes_per_s)), std::max(1, rate.pieces_at_once), now};
}

}  // namespace

SceneSender::SceneSender(std::shared_ptr<const handover::PackedScene> scene, const HandoverRate& rate, Nanoseconds now)
    : scene_(std::move(scene)),
      rate_(bucket(rate, now)),
      states_(scene_->announcement().pieces),
      due_(states_.size()),
      newest_of_(scene_->announcement().pieces) {
  chosen_.reserve(states_.size());
}

void SceneSender::on_motion(const wire::MotionSample& motion, Nanoseconds now) noexcept {
  wanted_ = motion.pieces.wanted;
  const Eigen::Index rows = std::min<Eigen::Index>(motion.position.rows(), 3);
  scene::Point place_m = scene::Point::Zero();
  place_m.head(rows) = motion.position.head(rows);
  const double interval_s = last_motion_ ? time::to_seconds(motion.device_time - *last_motion_) : 0;
  if (interval_s > 0) {
    const scene::Point velocity_m_per_s = (place_m - place_m_) / interval_s;
    velocity_m_per_s_ += (velocity_m_per_s - velocity_m_per_s_) * (interval_s / (interval_s + kSmooth_s));
    // Of a place that no device has.
    if (!velocity_m_per_s_.allFinite()) velocity_m_per_s_.setZero();
  }
  scene::Point way_m = velocity_m_per_s_ * (kAhead * time::to_seconds(round_trip_.value_or(kUnknownRoundTrip)));
  if (!(way_m.norm() <= kAheadMost_m)) way_m = scene::Point(way_m.stableNormalized() * kAheadMost_m);
  place_m_ = place_m;
  ahead_m_ = place_m + way_m;
  last_motion_ = motion.device_time;

  if (motion.pieces.newest == 0 || motion.pieces.newest > last_) return;
  acknowledge(motion.pieces.newest, now);
  for (std::uint64_t i = 0; i < 64 && i + 1 < motion.pieces.newest; ++i) {
    if (((motion.pieces.before >> i) & 1U) != 0) acknowledge(motion.pieces.newest - 1 - i, now);
  }
}

void SceneSender::acknowledge(std::uint64_t transmission, Nanoseconds now) noexcept {
  const Flight& there = flight(transmission);
  if (there.transmission != transmission) return;
  if (transmission > newest_acknowledged_) {
    // The first word of the newest is as old as the way there and back.
    newest_acknowledged_ = transmission;
    const Nanoseconds round_trip = now - there.sent;
    round_trip_ = round_trip_ ? *round_trip_ + (round_trip - *round_trip_) / 8 : round_trip;
  }
  set(there.number, State::there);
}

void SceneSender::set(std::uint32_t number, State state) noexcept {
  const State before = std::exchange(states_[number], state);
  if (state == before) return;
  if (due(before)) --due_;
  if (due(state)) ++due_;
  if (before == State::there) --there_;
  if (state == State::there) ++there_;
}

Nanoseconds SceneSender::patience() const noexcept {
  return std::max(kLeastPatience,
                  time::from_seconds(kPatience * time::to_seconds(round_trip_.value_or(kUnknownRoundTrip))));
}

void SceneSender::give_up_late(Nanoseconds now) noexcept {
  for (; first_ <= last_; ++first_) {
    const Flight& oldest = flight(first_);
    const bool newest = newest_of_[oldest.number] == oldest.transmission;
    if (newest && states_[oldest.number] != State::there) {
      if (now - oldest.sent < patience()) return;
      set(oldest.number, State::waiting);
      next_chosen_ = chosen_.size();  // it may be the nearest
    }
  }
}

/// Below zero for what comes first, in its order; of the rest the distance [m].
double SceneSender::urgency(std::uint32_t number) const noexcept {
  if (scene_->comes_first(number)) {
    const double rounds = states_[number] == State::to_be_doubled ? 1 : 2;
    return static_cast<double>(number) - rounds * static_cast<double>(states_.size());
  }
  const auto& where_m = scene_->where_m(number);
  return std::sqrt(std::min(where_m.squaredExteriorDistance(place_m_), where_m.squaredExteriorDistance(ahead_m_)));
}

void SceneSender::choose() noexcept {
  chosen_.clear();
  next_chosen_ = 0;
  chosen_at_m_ = ahead_m_;
  for (std::uint32_t number = 0; number < states_.size(); ++number) {
    if (due(states_[number])) chosen_.push_back(number);
  }
  const auto wanted = static_cast<std::ptrdiff_t>(std::min(kChosen, chosen_.size()));
  std::partial_sort(chosen_.begin(), chosen_.begin() + wanted, chosen_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return std::pair(urgency(a), a) < std::pair(urgency(b), b);
  });
  chosen_.resize(static_cast<std::size_t>(wanted));
}

std::optional<SceneSender::Sending> SceneSender::next(Nanoseconds now) noexcept {
  if (!wanted_ || there_ == states_.size()) return std::nullopt;
  give_up_late(now);
  // The rate first, which bounds how often a choice is made too.
  if (due_ == 0 || last_ + 1 - first_ >= kFlights || !rate_.take(now)) return std::nullopt;
  while (next_chosen_ < chosen_.size() && !due(states_[chosen_[next_chosen_]])) ++next_chosen_;
  const bool moved = (ahead_m_ - chosen_at_m_).norm() > kMoved_m;
  if (moved || next_chosen_ == chosen_.size()) choose();
  const std::uint32_t number = chosen_[next_chosen_++];
  ++last_;
  flight(last_) = {.transmission = last_, .number = number, .sent = now};
  const bool again = std::exchange(newest_of_[number], last_) != 0;
  set(number, scene_->comes_first(number) && !again ? State::to_be_doubled : State::on_its_way);
  return Sending{.transmission = last_, .number = number, .again = again};
}

}  // namespace forcebound::server
