#include "forcebound/client/app/client_program.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <csignal>
#include <stdexcept>
#include <string>

#include "forcebound/client/app/allocation.hpp"
#include "forcebound/client/app/options.hpp"
#include "forcebound/client/app/run.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"

namespace forcebound::client {
namespace {

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch what is lock-free");

void end_cleanly(int) { stop_asked = true; }

/// Sets the server that an allocator names, or keeps the one that was given.
void find_server(Options& options) {
  if (options.allocation.url.empty() || !options.law_help.empty()) return;
  try {
    options.client.server = allocate(options.allocation);
    spdlog::info("the allocator gave server {}", options.client.server);
  } catch (const std::runtime_error& error) {
    if (options.client.server.empty()) {
      throw std::runtime_error(std::string("no server from the allocator: ") + error.what() +
                               "; --server HOST:PORT would be used instead");
    }
    spdlog::warn("no server from the allocator: {}; using --server {}", error.what(), options.client.server);
  }
}

int run_until_stopped(Options options) {
  program::log_to_stderr(kProgram);
  find_server(options);
  std::signal(SIGINT, end_cleanly);
  std::signal(SIGTERM, end_cleanly);
  // A full disk or a closed pipe gives a write error, not a signal that ends the loop.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  return run(options, stop_asked);
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  return program::run(kProgram, [&] { return run_until_stopped(parse_options(argc, argv)); });
}

}  // namespace forcebound::client
