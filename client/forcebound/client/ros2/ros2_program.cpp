#include "forcebound/client/ros2/ros2_program.hpp"

#include <dds/ddsrt/log.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/client/app/run.hpp"
#include "forcebound/client/ros2/hand_on_topics.hpp"
#include "forcebound/client/ros2/options.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/server/app/log_observer.hpp"
#include "forcebound/server/runtime/embedded_server.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/printable.hpp"
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

server::EmbeddedServer::Settings settings_of(const Options& options, server::ServerObserver* observer) {
  constexpr int kPriority = 40;  // below the tick's
  return {.listen = options.listen.empty() ? "127.0.0.1:0" : options.listen,
          .keys = options.keys,
          .observer = observer,
          .priority = kPriority,
          .by_options = true};
}

/// Several times a second.
void look_after(const server::EmbeddedServer& server, HandOnTopics& hand) {
  hand.log_news();
  if (!server.is_running()) stop_asked = true;
}

/// The counts as JSON has them.
template <class Count>
std::vector<Count> named(const HandOnTopics& hand) {
  std::vector<Count> all;
  for (const HandOnTopics::Count& count : hand.counts()) all.push_back({count.name, count.count});
  return all;
}

/// @returns the exit code @param code of all else
int end(server::EmbeddedServer& server, const HandOnTopics& hand, int code) {
  const bool failed = server.stop() == server::EmbeddedServer::Stopped::with_failure;
  if (failed) spdlog::error("{}", server.failure());
  std::fputs(hand.totals().c_str(), stdout);
  return failed ? program::kFailed : code;
}

/// The device here is the client of a server in this process, whose environment the topics are.
int run_device(const Options& options) {
  client::Options own = options.client;
  if (!own.law_help.empty()) return client::run(own, stop_asked);
  HandOnTopics hand(options);
  server::EmbeddedServer server(settings_of(options, nullptr), hand.environment(), HandOnTopics::kSimulated);
  spdlog::info("{}", hand.in_words());
  (void)server.start();
  own.client.server = net::to_string(server.address());
  own.client.amendment = &hand.ages();
  const int code = client::run(own, stop_asked,
                               {.sinks = {&hand.ticks()},
                                .housekeeping = [&] { look_after(server, hand); },
                                .counts = [&] { return named<client::NamedCounts::value_type>(hand); }});
  return end(server, hand, code);
}

/// The device is another's, who is a client of the server here.
int run_server(const Options& options) {
  const std::string& summary = options.client.summary;
  if (!summary.empty()) text::expect_writable(summary);
  const time::SteadyClock clock;
  server::LogObserver log(clock);
  HandOnTopics hand(options);
  server::EmbeddedServer server(settings_of(options, &log), hand.environment(), HandOnTopics::kSimulated);
  spdlog::info("listening on {}, {}", net::to_string(server.address()), server.encryption_in_words());
  spdlog::info("{}", hand.in_words());
  (void)server.start();
  while (!stop_asked) {
    look_after(server, hand);
    std::this_thread::sleep_for(std::chrono::milliseconds{50});
  }
  const int code = end(server, hand, program::kDone);
  if (summary.empty()) return code;
  text::write_file(summary, server.summary(kProgramAndVersion, named<server::EmbeddedServer::OwnCount>(hand)));
  return code;
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
