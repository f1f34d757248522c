#include "forcebound/client/ros2/ros2_program.hpp"

#include <dds/ddsrt/log.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <stop_token>
#include <string>
#include <thread>

#include "forcebound/client/app/run.hpp"
#include "forcebound/client/ros2/hand_on_topics.hpp"
#include "forcebound/client/ros2/options.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/server/app/key_options.hpp"
#include "forcebound/server/app/log_observer.hpp"
#include "forcebound/server/runtime/udp_server.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::ros2 {
namespace {

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch what is lock-free");

void end_cleanly(int) { stop_asked = true; }

/// What DDS says of itself, as lines of the log.
void log_of_dds() {
  dds_set_log_sink(
      [](void*, const dds_log_data_t* line) {
        std::string text(line->message, line->size);
        while (!text.empty() && text.back() == '\n') text.pop_back();
        spdlog::warn("DDS: {}", text::printable(text));
      },
      nullptr);
}

void serve(server::UdpServer& server, const std::stop_token& ended) noexcept {
  // Below the tick's priority. Refused, it is as late as other threads.
  constexpr int kPriority = 40;
  (void)time::ask_for_first_in_first_out(kPriority);
  try {
    server.run(ended);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    stop_asked = true;
  }
}

/// The device here is the client of a server in this process, whose environment the topics are.
int run_device(const Options& options) {
  client::Options own = options.client;
  if (!own.law_help.empty()) return client::run(own, stop_asked);
  HandOnTopics hand(options);
  server::UdpServer server(server::listen({"127.0.0.1", 0}), {.scene = "ros2"}, hand.environments());
  own.client.server = net::to_string(server.address());
  int code = program::kFailed;
  {
    const std::jthread serving([&](const std::stop_token& ended) { serve(server, ended); });
    code = client::run(own, stop_asked, {.sinks = {&hand.ticks()}, .housekeeping = [&] { hand.log_news(); }});
  }
  std::fputs(hand.totals().c_str(), stdout);
  return code;
}

/// The device is another's, who is a client of the server here.
int run_server(const Options& options) {
  constexpr time::Nanoseconds kNews = std::chrono::milliseconds{50};
  const net::Address address = net::resolve(net::parse_endpoint(options.listen));
  server::expect_bounds(options.keys);
  server::expect_encryption(options.keys, address);
  auto keys = server::read_keys(options.keys, {"ros2"});
  const std::string encryption = server::encryption_in_words(options.keys, keys);
  HandOnTopics hand(options);
  const time::SteadyClock clock;
  server::LogObserver log(clock);
  server::UdpServer server(server::listen_at(address), {.scene = "ros2"}, hand.environments(), &log, std::move(keys));
  spdlog::info("listening on {}, {}", net::to_string(server.address()), encryption);
  time::Nanoseconds logged = clock.now();
  while (!stop_asked) {
    server.turn();
    if (clock.now() - logged < kNews) continue;
    hand.log_news();
    logged = clock.now();
  }
  server.stop();
  std::fputs(hand.totals().c_str(), stdout);
  return program::kDone;
}

int run(const Options& options) {
  program::log_to_stderr(kProgram);
  log_of_dds();
  std::signal(SIGINT, end_cleanly);
  std::signal(SIGTERM, end_cleanly);
  // A full disk or a closed pipe gives a write error, not a signal that ends the loop.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  return options.listen.empty() ? run_device(options) : run_server(options);
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  return program::run(kProgram, [&] { return run(parse_options(argc, argv)); });
}

}  // namespace forcebound::ros2
