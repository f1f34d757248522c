#pragma once

#include <string>

#include "forcebound/record/recorder.hpp"
#include "forcebound/record/recording_writer.hpp"

namespace forcebound::record {

/// Notices that a recording has become incomplete while it goes on, so that a person can be told at once.
///
/// Allocates. For the thread that drains the recorder.
class RecordingWatch {
 public:
  /// The reason, in one line, at the first call at which records are known to be missing; empty at all others, but a
  /// writer that fails later is told too.
  [[nodiscard]] std::string take(const Recorder& recorder, const RecordingWriter& writer);

 private:
  bool dropped_reported_ = false;
  bool failure_reported_ = false;
};

}  // namespace forcebound::record
