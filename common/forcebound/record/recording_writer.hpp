#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "forcebound/record/mcap_format.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/scene_part.hpp"
#include "forcebound/record/topic_encoder.hpp"

namespace forcebound::record {

/// A file that a recording has within.
struct RecordedFile {
  std::string name;        ///< "scene.toml"
  std::string media_type;  ///< "application/toml"
  std::string content;
};

/// Writes a recording: an MCAP file with Protocol Buffers messages, which Foxglove, PlotJuggler and the official
/// readers open, with the topics of TopicEncoder.
///
/// Chunks are compressed with zstd unless another is said.
///
/// Records reach the operating system every second of log time, so a killed process loses at most that. Log times are
/// the record's own, moved by `RunInfo::epoch` to wall-clock time.
///
/// A failing disk ends the recording, not the run: records that cannot be written are counted; `problem` has the
/// reason.
///
/// Allocates and blocks: not for the tick's thread. Not thread-safe.
class RecordingWriter {
 public:
  /// Creates the file, replacing one that is there.
  /// @throws std::runtime_error naming the file and the system's reason if it cannot be created.
  RecordingWriter(const std::filesystem::path& file, const RunInfo& info,
                  mcap::Compression compression = mcap::Compression::zstd);
  ~RecordingWriter();
  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;

  template <class Record>
  void write(const Record& record) {
    encoder().write(record);
  }

  /// How the scene looks from now on, in place of what was told before.
  void write_scene(std::span<const ScenePart> parts, Nanoseconds at) { encoder().write_scene(parts, at); }

  [[nodiscard]] TopicEncoder& encoder() noexcept;

  /// A file within the recording, for people: a scene, a device.
  void attach(const RecordedFile& file, Nanoseconds at);

  /// Hands all that was written to the operating system.
  void flush();

  /// Writes what is left, the totals and the index. Nothing can be written afterwards.
  void finish(const RunTotals& totals);

  /// Records that are known not to be in the file, all of them after `flush`; for RunTotals::recording_unwritten.
  [[nodiscard]] std::uint64_t unwritten() const noexcept;

  /// The fault and its time, for RunTotals::notes; empty if there was none.
  [[nodiscard]] std::string problem() const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace forcebound::record
