#include "forcebound/server/app/server_program.hpp"

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

namespace forcebound::server {
namespace {

std::string explanation(const ProgramOptions& options) {
  const time::SteadyClock clock;
  const auto built = build_scene(options, options.calibrate ? measured_by(clock) : scene::MeasureCost{});
  ExplainFacts facts{.answer_bytes = answer_bytes(*built), .device = options.device};
  const SuggestedHand suggested = suggested_hand(built);
  facts.hand = {.suggested = suggested, .trial = try_hand(built, suggested)};
  if (options.calibrate) facts.calibration = calibrate(built, clock);
  return text::wrapped_below_descriptions(text::printable_lines(explain(*built, facts)), 2);
}

int run(ProgramOptions options) {
  if (options.schema) {
    std::cout << schema(scene::Registry::standard());
  } else if (options.explain) {
    std::cout << explanation(options);
  } else if (options.suggest) {
    std::cout << text::printable(to_options(suggested_hand(build_scene(options)))) << "\n";
  } else {
    program::log_to_stderr(kProgram);
    return serve(std::move(options));
  }
  return program::kDone;
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  return program::run(kProgram, [&] { return run(parse_command_line(argc, argv)); });
}

}  // namespace forcebound::server
