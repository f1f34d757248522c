#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/unit/record/sample_run.hpp"

namespace {

using namespace forcebound::record;
using nlohmann::json;

json rows(const forcebound::control::Vector& vector) {
  return std::vector<double>(vector.data(), vector.data() + vector.size());
}

/// Writes the same run twice: as a recording, and as lines of JSON that share no code with it.
class Twice final : public TickSink {
 public:
  Twice(RecordingWriter& writer, std::ostream& truth) : writer_(writer), truth_(truth) {}

  void on_tick(const TickRecord& t) noexcept override {
    writer_.write(t);
    truth_ << json{{"topic", "/tick"},
                   {"tick", std::to_string(t.tick)},
                   {"time_ns", std::to_string(t.time.count())},
                   {"force_age_ns", std::to_string(t.force_age.count())},
                   {"policy", static_cast<int>(t.policy)},
                   {"position_m", rows(t.position)},
                   {"request_N", rows(t.request)},
                   {"applied_N", rows(t.applied)},
                   {"energy_J", t.energy_J},
                   {"audit_J", t.audit_J}}
           << '\n';
  }
  void on_force(const ForceRecord& f) noexcept override {
    writer_.write(f);
    truth_ << json{{"topic", "/force"},
                   {"receive_time_ns", std::to_string(f.receive_time.count())},
                   {"round_trip_ns", std::to_string(f.round_trip.count())},
                   {"force",
                    {{"session", std::to_string(f.force.session)},
                     {"force_N", rows(f.force.answer.force)},
                     {"contact_normal", rows(f.force.answer.contact_normal)}}}}
           << '\n';
  }

 private:
  RecordingWriter& writer_;
  std::ostream& truth_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: mcap_core_sample RECORDING.mcap TRUTH.jsonl\n";
    return 2;
  }
  RecordingWriter writer(argv[1], test::sample_info());
  std::ofstream truth(argv[2]);
  Twice twice(writer, truth);
  using Kind = ScenePart::Kind;
  std::vector<ScenePart> parts;
  for (const Kind kind : {Kind::plane, Kind::box, Kind::sphere, Kind::cavity, Kind::cylinder, Kind::capsule}) {
    parts.push_back({.name = "part", .kind = kind, .size_m = {0.01, 0.01, 0.02}});
  }
  parts.push_back({.name = "mesh",
                   .kind = Kind::mesh,
                   .vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                   .triangles = {{0, 1, 2}, {0, 1, 3}}});
  writer.write_scene(parts, test::kSampleStart);
  writer.attach({.name = "scene.toml", .media_type = "application/toml", .content = "name = \"sample\"\n"},
                test::kSampleStart);
  test::play_sample_run(twice, 3000);
  writer.finish(test::sample_totals());
  return writer.problem().empty() && truth ? 0 : 1;
}
