#include "forcebound/record/recording_reader.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "forcebound/record/internal/recording_codec.hpp"
#include "forcebound/record/mcap_reader.hpp"

namespace forcebound::record {
namespace {

constexpr std::string_view kOwnSchemas = "forcebound.";

/// Settings of every run have both from version 2 of the protocol on; one alone is missing where a byte is damaged.
bool are_of_version_1(const KeyValues& settings) {
  return !settings.contains("device_simulated") && !settings.contains("guarantee");
}

struct Dispatcher {
  RecordingSink& sink;
  Nanoseconds epoch{0};
  bool started = false;
  bool damaged = false;

  void start(const RunInfo& info) {
    epoch = info.epoch;
    started = true;
    sink.on_start(info);
  }

  void metadata(const std::string& name, const KeyValues& values) {
    std::string problem;
    if (name == kInfoMetadata && !started) {
      start(run_info_from(values, &problem));
    } else if (name == kTotalsMetadata) {
      if (!started) throw std::invalid_argument("it comes before 'forcebound.run'");
      sink.on_end(run_totals_from(values, &problem));
    }
    if (!problem.empty()) throw std::invalid_argument(problem);
  }

  void message(const mcap::Schema& schema, const mcap::Message& message) {
    if (!schema.name.starts_with(kOwnSchemas)) return;
    // Its settings may be what is damaged.
    if (!started && damaged) start({});
    if (!started)
      throw std::invalid_argument("a message before the metadata 'forcebound.run': not a Forcebound recording");
    if (schema.name == kTickSchema) {
      TickRecord tick;
      decode(message.data, tick);
      sink.on_tick(tick);
    } else if (schema.name == kForceSchema) {
      ForceRecord force;
      if (decode(message.data, force)) {
        sink.on_force(force);
      } else {
        sink.on_sent({.force = force.force});
      }
    } else if (schema.name == kMotionSchema) {
      // Unsigned, so that no file can make it overflow.
      const auto since_start = message.log_time - static_cast<std::uint64_t>(epoch.count());
      MotionRecord motion{Nanoseconds{static_cast<Nanoseconds::rep>(since_start)}, {}};
      decode(message.data, motion.motion);
      sink.on_motion(motion);
    } else if (schema.name == kEarlierSentForceSchema) {
      SentForceRecord force;
      decode(message.data, force.force);
      sink.on_sent(force);
    }
  }
};

}  // namespace

mcap::Ending read_recording(const std::filesystem::path& file, RecordingSink& sink) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) {
    throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(in ? EISDIR : errno));
  }
  Dispatcher dispatcher{sink};
  mcap::Visitor visitor;
  visitor.damage = [&](const std::string&) { dispatcher.damaged = true; };
  visitor.metadata = [&](const std::string& name, const KeyValues& values) {
    if (name == kInfoMetadata && are_of_version_1(values)) {
      throw std::runtime_error(file.string() + ": a recording of protocol version 1, expected version " +
                               std::to_string(wire::kProtocolVersion));
    }
    try {
      dispatcher.metadata(name, values);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("metadata '" + name + "': " + error.what());
    }
  };
  visitor.attachment = [&](const mcap::Attachment& attachment) {
    sink.on_file({attachment.name, attachment.media_type, std::string(attachment.data)});
  };
  visitor.message = [&](const mcap::Schema& schema, const mcap::Channel& channel, const mcap::Message& message) {
    try {
      dispatcher.message(schema, message);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("topic '" + channel.topic + "': " + error.what());
    }
  };
  mcap::Ending ending = mcap::read(in, file.string(), visitor);
  if (!dispatcher.started) {
    throw std::runtime_error(file.string() + ": not a Forcebound recording: it has no metadata 'forcebound.run'" +
                             (ending ? "" : "; " + mcap::in_words(ending)));
  }
  return ending;
}

std::string incomplete_in_words(const std::filesystem::path& file, const mcap::Ending& ending) {
  return file.string() + ": incomplete: " + mcap::in_words(ending) + "; shown is what is whole";
}

}  // namespace forcebound::record
