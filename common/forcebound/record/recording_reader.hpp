#pragma once

#include <filesystem>
#include <string>

#include "forcebound/record/mcap_reader.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"

namespace forcebound::record {

/// Receives a recording in the order in which it was written: `on_start`, then records and files, then `on_end` unless
/// the recording was cut off. A client's recording has ticks and received forces, a server's motions and sent forces.
class RecordingSink : public TickSink {
 public:
  virtual void on_start(const RunInfo& info) = 0;
  virtual void on_end(const RunTotals& totals) = 0;
  virtual void on_motion(const MotionRecord&) {}
  virtual void on_sent(const SentForceRecord&) {}
  virtual void on_file(const RecordedFile&) {}
};

/// Reads what RecordingWriter wrote; unknown topics are skipped, and so is what is damaged. Settings that are damaged
/// are those of RunInfo.
///
/// @returns whether all of the file is there and whole, as a condition; that of a killed process is not.
/// `mcap::in_words` says what is missing then.
/// @throws std::runtime_error naming the file and what is wrong with it: it cannot be read, or is no recording.
mcap::Ending read_recording(const std::filesystem::path& file, RecordingSink& sink);

/// For people, of a recording that is not whole: "run.mcap: incomplete: it ends at byte ...; shown is what is whole".
[[nodiscard]] std::string incomplete_in_words(const std::filesystem::path& file, const mcap::Ending& ending);

}  // namespace forcebound::record
