#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "forcebound/record/picture_rate.hpp"
#include "forcebound/record/scene_part.hpp"
#include "forcebound/record/server_records.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/record/topics.hpp"

namespace forcebound::record {

/// Makes messages of records, for a recording or for live viewers. Of a client they are of /tick and /force, of a
/// server of /motion and /force.
///
/// Beside them are pictures for Foxglove's 3D panel, by its own schemas: /scene whenever that is told, and 60 times a
/// second of the records' time /device, where a device's tip is, and /arrows, the forces on it, 10 mm for each newton.
///
/// Allocates: not for the tick's thread. Not thread-safe.
class TopicEncoder {
 public:
  /// @param epoch wall-clock time [since 1970] at time zero of the records. @param sink must outlive it
  TopicEncoder(Nanoseconds epoch, TopicSink& sink) : epoch_(epoch), sink_(sink) {}

  void write(const TickRecord& tick);
  void write(const ForceRecord& force);
  void write(const MotionRecord& motion);
  void write(const SentForceRecord& force);

  /// How the scene looks from now on, in place of what was told before.
  void write_scene(std::span<const ScenePart> parts, Nanoseconds at);

  [[nodiscard]] Nanoseconds wall_clock(Nanoseconds at) const noexcept;

 private:
  template <class Encode>
  void write(Topic topic, std::uint64_t sequence, Nanoseconds at, Encode encode);
  template <class Encode>
  void picture(Topic topic, Nanoseconds at, Encode encode);
  ShownSession* shown(std::uint64_t session, Nanoseconds at);
  void forget_ended_sessions(Nanoseconds at);

  Nanoseconds epoch_;
  TopicSink& sink_;
  std::uint64_t pictures_ = 0;
  PictureRate of_ticks_{};
  std::map<std::uint64_t, ShownSession> sessions_{};
  std::uint64_t sessions_seen_ = 0;
  Nanoseconds looked_for_ended_{0};
};

}  // namespace forcebound::record
