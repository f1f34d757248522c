#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>

#include "forcebound/client/app/options.hpp"
#include "forcebound/client/app/run.hpp"
#include "forcebound/text/terminal.hpp"

namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch what is lock-free");

void end_cleanly(int) { stop = true; }

}  // namespace

int main(int argc, char** argv) {
  const bool coloured = forcebound::text::colour_for(STDERR_FILENO) != forcebound::text::Colour::none;
  spdlog::set_default_logger(spdlog::stderr_color_mt(
      "forcebound-client", coloured ? spdlog::color_mode::automatic : spdlog::color_mode::never));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  const auto options = forcebound::client::parse_options(argc, argv);
  std::signal(SIGINT, end_cleanly);
  std::signal(SIGTERM, end_cleanly);
  // A full disk or a closed pipe gives a write error, not a signal that ends the loop.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return forcebound::client::run(options, stop);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "forcebound-client: %s\n", error.what());
    return 1;
  }
}
