#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "forcebound/client/app/identity_options.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/accuracy/percent.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/load/capacity.hpp"
#include "tests/tools/lab/load/load.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"

namespace forcebound::lab {
namespace {

struct LoadCommandOptions {
  LoadOptions load;
  std::size_t clients = 1;
  double duration_s = 2;
  bool find_most = false;
  std::string waiting = "sleep";
  CapacitySearch search;
  std::string json;
};

// Share of all motions sent that must be answered within that time. Unanswered motions count as late: where the machine
// loses milliseconds, a server answers only the newest motion of each session, by design.
constexpr double kServedShare = 0.99;
constexpr double kServiceMost_us = 1000;
constexpr const char* kHolds = "99 % of all motions sent answered within 1 ms, and 98 % of those due sent in time";

// Share of all motions sent in time: otherwise this program was late, not the server.
constexpr double kUnsentMost = 0.02;

double in_us(double ns) { return 1e-3 * ns; }

/// Of the answers, those with local models.
double share_modelled(const LoadResult& result) {
  return static_cast<double>(result.tally.modelled) /
         static_cast<double>(std::max<std::uint64_t>(1, result.tally.answered));
}

bool holds(const LoadResult& result) {
  const auto all = static_cast<double>(result.unsent + result.tally.sent);
  return static_cast<double>(result.unsent) <= kUnsentMost * all &&
         in_us(result.tally.answered_within_ns(kServedShare)) < kServiceMost_us;
}

/// What the clients asked for, and what came of it.
std::string asked_for(const LoadResult& result, const LoadGenerator::Settings& settings) {
  if (settings.echo) return "an echo";
  std::string words = std::string(settings.renders_locally ? "local" : "remote") + " rendering of " +
                      (settings.scene.empty() ? "the server's scene" : "scene " + settings.scene);
  if (!settings.renders_locally) return words;
  return words + "; received " + text::counted(result.handed_over.pieces, "piece") + ", " +
         text::rounded(1e-3 * static_cast<double>(result.handed_over.bytes)) + " kB, before the motions; " +
         percent(share_modelled(result)) + " of the answers with local models";
}

std::string lines_of(const LoadResult& result, const LoadGenerator::Settings& settings) {
  const auto percentiles = [](const record::Histogram& ns) {
    return text::rounded(in_us(ns.percentile(0.5))) + " us median, " + text::rounded(in_us(ns.percentile(0.99))) +
           " p99, " + text::rounded(in_us(ns.max())) + " max\n";
  };
  return text::counted(result.clients, "client") + ": " + text::counted(result.tally.sent, "motion") + ", " +
         std::to_string(result.lost()) + " lost, " + std::to_string(result.unsent) + " not sent in time\n" +
         "  service     " + percentiles(result.tally.arrived_ns) + "  until read  " +
         percentiles(result.tally.read_ns) + text::wrapped("  asked for   " + asked_for(result, settings), 14) + '\n';
}

nlohmann::ordered_json to_json(const LoadResult& result, const LoadGenerator::Settings& settings) {
  const auto percentiles = [](const record::Histogram& ns) {
    return nlohmann::ordered_json{
        {"p50", in_us(ns.percentile(0.5))}, {"p99", in_us(ns.percentile(0.99))}, {"max", in_us(ns.max())}};
  };
  return {{"clients", result.clients},
          {"scene", settings.scene},
          {"rendering",
           {{"asked", settings.renders_locally ? "local" : "remote"},
            {"modelled", share_modelled(result)},
            {"scene_pieces", result.handed_over.pieces},
            {"scene_piece_bytes", result.handed_over.bytes}}},
          {"sent", result.tally.sent},
          {"lost", result.lost()},
          {"unsent", result.unsent},
          {"service_us", percentiles(result.tally.arrived_ns)},
          {"read_us", percentiles(result.tally.read_ns)}};
}

LoadResult most(const LoadCommandOptions& options, Load& load) {
  std::optional<LoadResult> best;
  const std::size_t clients = most_that_hold(options.search, [&](std::size_t tried) {
    const LoadResult result = load.run(tried);
    const bool held = holds(result);
    std::cout << lines_of(result, options.load.load_generator) << std::flush;
    if (held) best = result;
    return held;
  });
  if (!best) throw std::runtime_error("not even one client gets its answers in time");
  std::cout << text::wrapped("most: " + text::counted(clients, "client") + " with " + kHolds, 2) << '\n';
  return *best;
}

LoadOptions::Waiting waiting_of(const std::string& name) {
  if (name == "sleep") return LoadOptions::Waiting::asleep;
  return name == "spin" ? LoadOptions::Waiting::spinning : LoadOptions::Waiting::ping_pong;
}

void run(LoadCommandOptions& options) {
  results::prepare({.files = {options.json}});
  options.load.waiting = waiting_of(options.waiting);
  options.load.duration = time::from_seconds(options.duration_s);
  Load load(options.load);
  const LoadResult result = options.find_most ? most(options, load) : load.run(options.clients);
  if (!options.find_most) std::cout << lines_of(result, options.load.load_generator);
  std::cout << std::flush;
  if (!options.json.empty())
    text::write_file(options.json, to_json(result, options.load.load_generator).dump(2) + '\n');
}

}  // namespace

void add_load(CLI::App& app) {
  auto options = std::make_shared<LoadCommandOptions>();
  CLI::App* command =
      app.add_subcommand("load", "Many clients at 1 kHz each against a running server, over real sockets");
  command->add_option("--server", options->load.server, "server to load")
      ->required()
      ->check(program::accepted_by([](const std::string& peer) { (void)net::parse_peer(peer); }))
      ->type_name("HOST:PORT");
  client::add_identity_options(*command, options->load.identity);
  CLI::Option* const clients = command->add_option("--clients", options->clients, "how many");
  clients->type_name("N")->check(program::whole_within(1, 10000))->capture_default_str();
  command->add_option("--sockets", options->load.sockets, "number of sockets that the clients share")
      ->type_name("N")
      ->check(program::whole_within(1, 1000))
      ->capture_default_str();
  command->add_option("--seconds", options->duration_s, "length of one measurement")
      ->type_name("SECONDS")
      ->check(program::number_above_zero())
      ->capture_default_str();
  CLI::Option* const find_most = command->add_flag(
      "--find-most", options->find_most,
      std::string("search for the most clients with ") + kHolds + "; a motion that is never answered counts as late");
  find_most->excludes(clients);
  command->add_option("--limit", options->search.limit, "with --find-most: try no more")
      ->needs(find_most)
      ->type_name("N")
      ->check(program::whole_within(1, 10000))
      ->capture_default_str();
  command->add_option("--dof", options->load.load_generator.degrees_of_freedom, "degrees of freedom of the clients")
      ->type_name("N")
      ->check(program::whole_within(1, 6))
      ->capture_default_str();
  command->add_option("--scene", options->load.load_generator.scene, "scene to request; default: the server's")
      ->type_name("NAME");
  CLI::Option* const rendering = add_rendering_option(*command, options->load.load_generator.renders_locally);
  command->add_option("--height", options->load.load_generator.height_m, "z of the circles in which the hands move")
      ->type_name("METRES")
      ->check(program::number_within(-1, 1))
      ->capture_default_str();
  command
      ->add_flag("--echo", options->load.load_generator.echo,
                 "the other end is a plain echo server: it only sends datagrams back")
      ->excludes(rendering);
  command
      ->add_option("--wait", options->waiting,
                   "sleep; or spin, so that no motion is late because this program had to wake up; or ping-pong: spin "
                   "until the next motion, sleep for its answer")
      ->type_name("sleep|ping-pong|spin")
      ->check(program::one_of("way to wait", {"sleep", "ping-pong", "spin"}))
      ->capture_default_str();
  command->add_option("--cpu", options->load.processor, "pin to this processor")
      ->type_name("N")
      ->check(program::whole_within(0, 1023));
  command->add_option("--priority", options->load.priority, "real-time scheduling, SCHED_FIFO")
      ->type_name("N")
      ->check(program::whole_within(1, 99));
  program::add_output(*command, "--json", options->json, "write the result to this file as well")
      ->type_name("FILE.json");
  command->footer(
      "With --rendering local each client asks for the scene and for local models, as forcebound-client does. All have "
      "the whole scene before a measurement begins.\n"
      "\n"
      "Examples:\n"
      "  forcebound-lab load --server 127.0.0.1:47800 --clients 20\n"
      "  forcebound-lab load --server 127.0.0.1:47800 --find-most --wait spin\n"
      "  forcebound-lab load --server 127.0.0.1:47800 --scene pad --height -0.003 --rendering local");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
