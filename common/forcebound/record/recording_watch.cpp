#include "forcebound/record/recording_watch.hpp"

#include <utility>

namespace forcebound::record {

std::string RecordingWatch::take(const Recorder& recorder, const RecordingWriter& writer) {
  if (!failure_reported_) {
    if (std::string problem = writer.problem(); !problem.empty()) {
      failure_reported_ = true;
      return problem;
    }
  }
  if (recorder.dropped() == 0 || std::exchange(dropped_reported_, true)) return {};
  return "the recording is incomplete: its disk takes records more slowly than they come, and some were left out";
}

}  // namespace forcebound::record
