// A client for a consumer's own device. There is no server on port 9: it ticks, gets no force, and ends with zero
// force.
#include <forcebound/client/runtime/client.hpp>
#include <forcebound/control/law_registry.hpp>

#include <atomic>
#include <cstdio>
#include <exception>

#include "slider.hpp"

int main() try {
  namespace client = forcebound::client;
  Slider slider;
  const std::atomic<bool> stop{false};
  client::Client run({.server = "127.0.0.1:9", .duration_s = 0.2, .once = true, .program = "feel_with_a_slider"},
                     slider, forcebound::control::force_bounding_laws().make("fba-exact", slider.facts()));
  run.run(stop);
  std::printf("%s%s\n", run.summary().to_text().c_str(), run.why_no_session().c_str());
  const bool ticked = slider.bus.powered && slider.bus.readings > 0;
  return ticked && slider.bus.force_N == 0 && !run.why_no_session().empty() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "feel_with_a_slider: %s\n", error.what());
  return 1;
}
