#include "forcebound/record/topic_encoder.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "forcebound/record/internal/foxglove_codec.hpp"
#include "forcebound/record/internal/recording_codec.hpp"

namespace forcebound::record {
namespace {

constexpr std::array<double, 3> kOrange{0.95, 0.55, 0.1};
constexpr std::array<double, 3> kGrey{0.5, 0.5, 0.5};
constexpr std::array<double, 3> kBlue{0.2, 0.45, 0.9};

constexpr std::size_t kSessionsShownMost = 256;
constexpr Nanoseconds kEndedAfter = std::chrono::seconds{10};  // without a motion or force
constexpr Nanoseconds kLooksForEndedEach = std::chrono::seconds{1};

}  // namespace

Nanoseconds TopicEncoder::wall_clock(Nanoseconds at) const noexcept { return std::max(epoch_ + at, Nanoseconds{0}); }

template <class Encode>
void TopicEncoder::write(Topic topic, std::uint64_t sequence, Nanoseconds at, Encode encode) {
  if (!sink_.wants(topic)) return;
  const std::string content = encode();
  sink_.take(
      {.topic = topic, .sequence = static_cast<std::uint32_t>(sequence), .at = wall_clock(at), .content = content});
}

template <class Encode>
void TopicEncoder::picture(Topic topic, Nanoseconds at, Encode encode) {
  write(topic, ++pictures_, at, encode);
}

/// The pictures of a server have a device for each session, numbered in the order in which they came.
/// Null: so many others are shown that this one is not.
ShownSession* TopicEncoder::shown(std::uint64_t session, Nanoseconds at) {
  const auto known = sessions_.find(session);
  if (known != sessions_.end()) {
    known->second.seen = at;
    return &known->second;
  }
  if (sessions_.size() >= kSessionsShownMost) forget_ended_sessions(at);
  if (sessions_.size() >= kSessionsShownMost) return nullptr;
  const std::string device = "server's device " + std::to_string(++sessions_seen_);
  return &sessions_.emplace(session, ShownSession{.device = device, .seen = at}).first->second;
}

void TopicEncoder::forget_ended_sessions(Nanoseconds at) {
  if (at - looked_for_ended_ < kLooksForEndedEach) return;
  looked_for_ended_ = at;
  std::erase_if(sessions_, [at](const auto& session) { return at - session.second.seen > kEndedAfter; });
}

void TopicEncoder::write(const TickRecord& tick) {
  write(Topic::tick, tick.tick, tick.time, [&] { return encode(tick); });
  if (!of_ticks_.take(tick.time)) return;
  constexpr std::string_view kDevice = "device";
  const Nanoseconds at = wall_clock(tick.time);
  picture(Topic::device, tick.time, [&] { return encode_device(kDevice, tick.position, tick.handle, at); });
  const std::array<ShownForce, 3> forces{{{"displayed force", tick.applied, kOrange},
                                          {"requested force", tick.request, kGrey},
                                          {"remote force", tick.remote, kBlue}}};
  picture(Topic::arrows, tick.time, [&] { return encode_arrows(kDevice, tick.position, forces, at); });
}

void TopicEncoder::write(const ForceRecord& force) {
  write(Topic::force, force.force.sequence, force.receive_time, [&] { return encode(force); });
}

void TopicEncoder::write(const MotionRecord& motion) {
  const Nanoseconds at = motion.receive_time;
  write(Topic::motion, motion.motion.sequence, at, [&] { return encode(motion.motion); });
  ShownSession* const session = shown(motion.motion.session, at);
  if (session == nullptr || !session->motions.take(at)) return;
  picture(Topic::device, at,
          [&] { return encode_device(session->device, motion.motion.position, motion.motion.handle, wall_clock(at)); });
}

void TopicEncoder::write(const SentForceRecord& force) {
  const Nanoseconds at = force.force.server_send_time;
  write(Topic::force, force.force.sequence, at, [&] { return encode(force); });
  ShownSession* const session = shown(force.force.session, at);
  if (session == nullptr || !session->forces.take(at)) return;
  const std::array<ShownForce, 1> forces{{{"sent force", force.force.answer.force, kBlue}}};
  picture(Topic::arrows, at,
          [&] { return encode_arrows(session->device, force.force.position, forces, wall_clock(at)); });
}

void TopicEncoder::write_scene(std::span<const ScenePart> parts, Nanoseconds at) {
  picture(Topic::scene, at, [&] { return encode_scene(parts, wall_clock(at)); });
}

}  // namespace forcebound::record
