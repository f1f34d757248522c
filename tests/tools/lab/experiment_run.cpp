#include "tests/tools/lab/experiment_run.hpp"

#include <cmath>

#include "tests/tools/lab/trials/measures.hpp"

namespace forcebound::lab {

double ExperimentRun::displayed_stiffness_N_per_m() const {
  const auto& median = summary["displayed_stiffness_N_per_m"]["median"];
  return median.is_number() ? median.get<double>() : std::nan("");
}

ExperimentRun run_experiment(const Experiment& experiment, const std::string& law, results::LawsFigure* figure) {
  RingingMeter ringing;
  DirectionMeter direction;
  std::vector<record::TickSink*> sinks{&ringing, &direction};
  if (figure != nullptr) sinks.push_back(&figure->add_run(law, law));
  sim::ClosedLoop loop(experiment.settings(law), sinks);
  loop.run(time::from_seconds(experiment.duration_s));
  return {law, nlohmann::json::parse(loop.close().to_json()), ringing.ringing_s(), direction.error_rad_max()};
}

}  // namespace forcebound::lab
