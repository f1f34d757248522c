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

namespace {

namespace client = forcebound::client;

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch what is lock-free");

void end_cleanly(int) { stop = true; }

/// Sets the server that an allocator names, or keeps the one that was given.
void find_server(client::Options& options) {
  if (options.allocation.url.empty() || !options.law_help.empty()) return;
  try {
    options.server = client::allocate(options.allocation);
    spdlog::info("the allocator gave server {}", options.server);
  } catch (const std::runtime_error& error) {
    if (options.server.empty()) {
      throw std::runtime_error(std::string("no server from the allocator: ") + error.what() +
                               "; --server HOST:PORT would be used instead");
    }
    spdlog::warn("no server from the allocator: {}; using --server {}", error.what(), options.server);
  }
}

int run(client::Options options) {
  forcebound::program::log_to_stderr(client::kProgram);
  find_server(options);
  std::signal(SIGINT, end_cleanly);
  std::signal(SIGTERM, end_cleanly);
  // A full disk or a closed pipe gives a write error, not a signal that ends the loop.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  return client::run(options, stop);
}

}  // namespace

int main(int argc, char** argv) {
  return forcebound::program::run(client::kProgram, [&] { return run(client::parse_options(argc, argv)); });
}
