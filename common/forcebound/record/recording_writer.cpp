#include "forcebound/record/recording_writer.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>

#include "forcebound/record/internal/foxglove_codec.hpp"
#include "forcebound/record/internal/picture_rate.hpp"
#include "forcebound/record/internal/recording_codec.hpp"
#include "forcebound/record/mcap_writer.hpp"

namespace forcebound::record {

namespace {

constexpr std::array<double, 3> kOrange{0.95, 0.55, 0.1};
constexpr std::array<double, 3> kGrey{0.5, 0.5, 0.5};
constexpr std::array<double, 3> kBlue{0.2, 0.45, 0.9};

constexpr std::size_t kSessionsShownMost = 256;
constexpr Nanoseconds kEndedAfter = std::chrono::seconds{10};  // without a motion or force
constexpr Nanoseconds kLooksForEndedEach = std::chrono::seconds{1};

constexpr std::string_view kTicks = "/tick";
constexpr std::string_view kForces = "/force";
constexpr std::string_view kMotions = "/motion";
/// All other topics show in pictures what these record.
constexpr std::array kTopicsOfRecords{kTicks, kForces, kMotions};

}  // namespace

struct RecordingWriter::Storage {
  std::filesystem::path path;
  Nanoseconds epoch;
  std::ofstream file;
  std::optional<mcap::Writer> mcap;
  std::map<std::string_view, std::uint16_t> channels{};  // by topic, declared at the first message
  std::uint64_t pictures = 0;
  PictureRate of_ticks{};
  std::map<std::uint64_t, ShownSession> sessions{};
  std::uint64_t sessions_seen = 0;
  Nanoseconds looked_for_ended{0};

  [[nodiscard]] Nanoseconds wall_clock(Nanoseconds at) const { return std::max(epoch + at, Nanoseconds{0}); }

  void write(std::string_view topic, std::string_view schema, std::uint64_t sequence, Nanoseconds at,
             const std::string& message) {
    auto channel = channels.find(topic);
    if (channel == channels.end()) {
      const auto id = mcap->add_channel(topic, schema, kProtobufEncoding, schema_of(schema), kProtobufEncoding);
      channel = channels.emplace(topic, id).first;
    }
    mcap->write(channel->second, static_cast<std::uint32_t>(sequence),
                static_cast<std::uint64_t>(wall_clock(at).count()), message);
  }

  void picture(std::string_view topic, std::string_view schema, Nanoseconds at, const std::string& message) {
    write(topic, schema, ++pictures, at, message);
  }

  /// The pictures of a server have a device for each session, numbered in the order in which they came.
  /// Null: so many others are shown that this one is not.
  ShownSession* shown(std::uint64_t session, Nanoseconds at) {
    const auto known = sessions.find(session);
    if (known != sessions.end()) {
      known->second.seen = at;
      return &known->second;
    }
    if (sessions.size() >= kSessionsShownMost) forget_ended_sessions(at);
    if (sessions.size() >= kSessionsShownMost) return nullptr;
    const std::string device = "server's device " + std::to_string(++sessions_seen);
    return &sessions.emplace(session, ShownSession{.device = device, .seen = at}).first->second;
  }

  void forget_ended_sessions(Nanoseconds at) {
    if (at - looked_for_ended < kLooksForEndedEach) return;
    looked_for_ended = at;
    std::erase_if(sessions, [at](const auto& session) { return at - session.second.seen > kEndedAfter; });
  }
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RunInfo& info, mcap::Compression compression)
    : storage_(std::make_unique<Storage>()) {
  storage_->path = file;
  storage_->epoch = info.epoch;
  errno = 0;
  storage_->file.open(file, std::ios::binary | std::ios::trunc);
  if (!storage_->file) {
    throw std::runtime_error("cannot create the recording '" + file.string() + "': " + std::strerror(errno));
  }
  storage_->mcap.emplace(storage_->file, info.program, compression);
  storage_->mcap->add_metadata(kInfoMetadata, to_key_values(info));
  // Protocol Buffers makes what it knows of messages at their first use: here, not on the thread that will write.
  (void)schema_of(kTickSchema);
}

RecordingWriter::~RecordingWriter() = default;
RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;
RecordingWriter& RecordingWriter::operator=(RecordingWriter&&) noexcept = default;

void RecordingWriter::write(const TickRecord& tick) {
  storage_->write(kTicks, kTickSchema, tick.tick, tick.time, encode(tick));
  if (!storage_->of_ticks.take(tick.time)) return;
  constexpr std::string_view kDevice = "device";
  const Nanoseconds at = storage_->wall_clock(tick.time);
  storage_->picture("/device", kFrameTransformSchema, tick.time,
                    encode_device(kDevice, tick.position, tick.handle, at));
  const std::array<ShownForce, 3> forces{{{"displayed force", tick.applied, kOrange},
                                          {"requested force", tick.request, kGrey},
                                          {"remote force", tick.remote, kBlue}}};
  storage_->picture("/arrows", kSceneUpdateSchema, tick.time, encode_arrows(kDevice, tick.position, forces, at));
}

void RecordingWriter::write(const ForceRecord& force) {
  storage_->write(kForces, kForceSchema, force.force.sequence, force.receive_time, encode(force));
}

void RecordingWriter::write(const MotionRecord& motion) {
  storage_->write(kMotions, kMotionSchema, motion.motion.sequence, motion.receive_time, encode(motion.motion));
  ShownSession* const session = storage_->shown(motion.motion.session, motion.receive_time);
  if (session == nullptr || !session->motions.take(motion.receive_time)) return;
  storage_->picture("/device", kFrameTransformSchema, motion.receive_time,
                    encode_device(session->device, motion.motion.position, motion.motion.handle,
                                  storage_->wall_clock(motion.receive_time)));
}

void RecordingWriter::write(const SentForceRecord& force) {
  const Nanoseconds at = force.force.server_send_time;
  storage_->write(kForces, kForceSchema, force.force.sequence, at, encode(force));
  ShownSession* const session = storage_->shown(force.force.session, at);
  if (session == nullptr || !session->forces.take(at)) return;
  const std::array<ShownForce, 1> forces{{{"sent force", force.force.answer.force, kBlue}}};
  storage_->picture("/arrows", kSceneUpdateSchema, at,
                    encode_arrows(session->device, force.force.position, forces, storage_->wall_clock(at)));
}

void RecordingWriter::write_scene(std::span<const ScenePart> parts, Nanoseconds at) {
  storage_->picture("/scene", kSceneUpdateSchema, at, encode_scene(parts, storage_->wall_clock(at)));
}

void RecordingWriter::attach(const RecordedFile& file, Nanoseconds at) {
  storage_->mcap->add_attachment(file.name, file.media_type,
                                 static_cast<std::uint64_t>(storage_->wall_clock(at).count()), file.content);
}

void RecordingWriter::flush() { storage_->mcap->flush(); }

void RecordingWriter::finish(const RunTotals& totals) {
  storage_->mcap->add_metadata(kTotalsMetadata, to_key_values(totals));
  storage_->mcap->close();
}

std::uint64_t RecordingWriter::unwritten() const noexcept {
  std::uint64_t all = 0;
  for (const std::string_view topic : kTopicsOfRecords) {
    const auto channel = storage_->channels.find(topic);
    if (channel != storage_->channels.end()) all += storage_->mcap->unwritten(channel->second);
  }
  return all;
}

std::string RecordingWriter::problem() const {
  const mcap::Writer& mcap = *storage_->mcap;
  if (!mcap.failed()) return {};
  return "recording '" + storage_->path.string() + "' ends after " + std::to_string(mcap.written()) +
         " messages: " + std::strerror(mcap.error());
}

}  // namespace forcebound::record
