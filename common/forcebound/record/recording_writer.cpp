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

struct RecordingWriter::Storage final : TopicSink {
  std::filesystem::path path;
  std::ofstream file;
  std::optional<mcap::Writer> mcap;
  std::map<Topic, std::uint16_t> channels{};  // declared at the first message
  TopicEncoder encoder;

  explicit Storage(Nanoseconds epoch) : encoder(epoch, *this) {}

  [[nodiscard]] bool wants(Topic) const noexcept override { return true; }

  void take(const TopicMessage& message) override {
    auto channel = channels.find(message.topic);
    if (channel == channels.end()) {
      const auto& [name, schema, is_picture] = info_of(message.topic);
      const auto id = mcap->add_channel(name, schema, kProtobufEncoding, schema_of(schema), kProtobufEncoding);
      channel = channels.emplace(message.topic, id).first;
    }
    mcap->write(channel->second, message.sequence, static_cast<std::uint64_t>(message.at.count()), message.content);
  }
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RunInfo& info, mcap::Compression compression)
    : storage_(std::make_unique<Storage>(info.epoch)) {
  storage_->path = file;
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

TopicEncoder& RecordingWriter::encoder() noexcept { return storage_->encoder; }

void RecordingWriter::attach(const RecordedFile& file, Nanoseconds at) {
  storage_->mcap->add_attachment(file.name, file.media_type,
                                 static_cast<std::uint64_t>(storage_->encoder.wall_clock(at).count()), file.content);
}

void RecordingWriter::flush() { storage_->mcap->flush(); }

void RecordingWriter::finish(const RunTotals& totals) {
  storage_->mcap->add_metadata(kTotalsMetadata, to_key_values(totals));
  storage_->mcap->close();
}

std::uint64_t RecordingWriter::unwritten() const noexcept {
  std::uint64_t all = 0;
  for (const auto& [topic, channel] : storage_->channels) {
    if (!info_of(topic).is_picture) all += storage_->mcap->unwritten(channel);
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
