#include <atomic>
#include <csignal>

#include "forcebound/client/app/options.hpp"
#include "forcebound/client/app/run.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"

namespace {

namespace client = forcebound::client;

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch what is lock-free");

void end_cleanly(int) { stop = true; }

int run(const client::Options& options) {
  forcebound::program::log_to_stderr(client::kProgram);
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
