#include "forcebound/record/recorder.hpp"

namespace forcebound::record {

std::size_t Recorder::drain(RecordingWriter& writer) {
  std::size_t written = 0;
  for (Item item; queue_.try_dequeue(item); ++written) {
    std::visit([&writer](const auto& record) { writer.write(record); }, item);
  }
  return written;
}

}  // namespace forcebound::record
