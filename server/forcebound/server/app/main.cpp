#include <iostream>
#include <utility>

#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/server/app/build_scene.hpp"
#include "forcebound/server/app/options.hpp"
#include "forcebound/server/app/serve.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/schema.hpp"
#include "forcebound/server/session/answer_size.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace {

using namespace forcebound;

std::string explanation(const server::ProgramOptions& options) {
  const time::SteadyClock clock;
  const auto built =
      server::build_scene(options, options.calibrate ? server::measured_by(clock) : scene::MeasureCost{});
  server::ExplainFacts facts{.answer_bytes = server::answer_bytes(*built), .device = options.device};
  const server::SuggestedHand suggested = server::suggested_hand(built);
  facts.hand = {.suggested = suggested, .trial = server::try_hand(built, suggested)};
  if (options.calibrate) facts.calibration = server::calibrate(built, clock);
  return text::wrapped_below_descriptions(text::printable_lines(server::explain(*built, facts)), 2);
}

int run(server::ProgramOptions options) {
  if (options.schema) {
    std::cout << server::schema(scene::Registry::standard());
  } else if (options.explain) {
    std::cout << explanation(options);
  } else if (options.suggest) {
    std::cout << text::printable(to_options(server::suggested_hand(server::build_scene(options)))) << "\n";
  } else {
    program::log_to_stderr(server::kProgram);
    return server::serve(std::move(options));
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return program::run(server::kProgram, [&] { return run(server::parse_command_line(argc, argv)); });
}
