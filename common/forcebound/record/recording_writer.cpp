#include "forcebound/record/recording_writer.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>

#include "forcebound/record/internal/recording_codec.hpp"
#include "forcebound/record/mcap_writer.hpp"

namespace forcebound::record {

struct RecordingWriter::Storage {
  std::filesystem::path path;
  Nanoseconds epoch;
  std::ofstream file;
  std::optional<mcap::Writer> mcap;
  std::map<std::string_view, std::uint16_t> channels;  // by schema, declared at the first message

  void write(std::string_view topic, std::string_view schema, std::uint64_t sequence, Nanoseconds at,
             const std::string& message) {
    auto channel = channels.find(schema);
    if (channel == channels.end()) {
      const auto id = mcap->add_channel(topic, schema, kProtobufEncoding, schema_of(schema), kProtobufEncoding);
      channel = channels.emplace(schema, id).first;
    }
    const Nanoseconds log_time = std::max(epoch + at, Nanoseconds{0});
    mcap->write(channel->second, static_cast<std::uint32_t>(sequence), static_cast<std::uint64_t>(log_time.count()),
                message);
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
}

RecordingWriter::~RecordingWriter() = default;
RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;
RecordingWriter& RecordingWriter::operator=(RecordingWriter&&) noexcept = default;

void RecordingWriter::write(const TickRecord& tick) {
  storage_->write("/tick", kTickSchema, tick.tick, tick.time, encode(tick));
}

void RecordingWriter::write(const ForceRecord& force) {
  storage_->write("/force", kForceSchema, force.force.sequence, force.receive_time, encode(force));
}

void RecordingWriter::write(const MotionRecord& motion) {
  storage_->write("/motion", kMotionSchema, motion.motion.sequence, motion.receive_time, encode(motion.motion));
}

void RecordingWriter::write(const SentForceRecord& force) {
  storage_->write("/force", kSentForceSchema, force.force.sequence, force.force.server_send_time, encode(force.force));
}

void RecordingWriter::flush() { storage_->mcap->flush(); }

void RecordingWriter::finish(const RunTotals& totals) {
  storage_->mcap->add_metadata(kTotalsMetadata, to_key_values(totals));
  storage_->mcap->close();
}

std::uint64_t RecordingWriter::unwritten() const noexcept { return storage_->mcap->unwritten(); }

std::string RecordingWriter::problem() const {
  const mcap::Writer& mcap = *storage_->mcap;
  if (!mcap.failed()) return {};
  return "recording '" + storage_->path.string() + "' ends after " + std::to_string(mcap.written()) +
         " records: " + std::strerror(mcap.error());
}

}  // namespace forcebound::record
