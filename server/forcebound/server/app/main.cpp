#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <iostream>
#include <memory>
#include <utility>

#include "forcebound/server/app/options.hpp"
#include "forcebound/server/app/serve.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/schema.hpp"
#include "forcebound/server/session/answer_size.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace {

// Logs go to stderr; stdout is for results: explanations and totals.
void log_to_stderr() {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("server", std::make_shared<spdlog::sinks::stderr_sink_st>()));
  spdlog::set_pattern("%H:%M:%S.%e %n: %v");
}

void explain(const forcebound::server::ProgramOptions& options) {
  using namespace forcebound::server;
  namespace scene = forcebound::scene;
  const forcebound::time::SteadyClock clock;
  const auto built = load_scene(options.scene, scene::EffectRegistry::standard(),
                                options.calibrate ? measured_by(clock) : scene::MeasureCost{});
  ExplainFacts facts{.answer_bytes = answer_bytes(*built), .device = options.device};
  const SuggestedHand suggested = suggested_hand(built);
  facts.hand = {.suggested = suggested, .trial = try_hand(built, suggested)};
  if (options.calibrate) facts.calibration = calibrate(built, clock);
  std::cout << forcebound::text::wrapped(explain(*built, facts), 6);
}

}  // namespace

int main(int argc, char** argv) {
  auto [options, exit_code] = forcebound::server::parse_command_line(argc, argv);
  if (exit_code) return *exit_code;
  try {
    if (options.schema) {
      std::cout << forcebound::server::schema(forcebound::scene::EffectRegistry::standard());
      return 0;
    }
    if (options.explain) {
      explain(options);
      return 0;
    }
    if (options.suggest) {
      using namespace forcebound::server;
      std::cout << to_options(suggested_hand(load_scene(options.scene))) << "\n";
      return 0;
    }
    log_to_stderr();
    forcebound::server::serve(std::move(options));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "forcebound-server: " << error.what() << "\n";
    return 1;
  }
}
