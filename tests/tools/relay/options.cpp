#include "tests/tools/relay/options.hpp"

#include <CLI/CLI.hpp>
#include <string_view>

#include "forcebound/program/command_line.hpp"
#include "forcebound/program/exit_codes.hpp"
#include "tests/tools/netem/netem_values.hpp"
#include "tests/tools/relay/blackhole.hpp"

namespace forcebound::relay {
namespace {

constexpr const char* kAbout =
    "Emulates a network between forcebound-client and forcebound-server: delay, jitter, loss, bursts, duplicates, "
    "corruption, reordering, a slow line, or a recorded network.\n"
    "\n"
    "Point the client at --listen; the relay talks to the server at --upstream.\n";

constexpr std::string_view kMore =
    "\n"
    "Traces (--trace), for both directions, starting with the relay and over again after their end:\n"
    "  CSV        with the header send_time_ms,rtt_ms: half of the round trip each way, interpolated; a hole of more "
    "than 1 s is a blackout, and what is sent in it is lost. Adds to the words of --netem. The queue then holds 100000 "
    "packets unless limit says otherwise.\n"
    "  mahimahi   one whole millisecond per line, each an opportunity to deliver 1500 bytes\n"
    "\n"
    "Differences from tc: all randomness of a direction comes from one generator seeded by --seed, which is printed at "
    "start, so the same seed gives the same fate to the same packets; netem draws from the kernel's own. A slot never "
    "exceeds its bytes, except by a packet that is larger than a slot. loss with a correlation loses far less (or "
    "more) than its percentage, as in netem, and is warned about: for bursts use 'loss gemodel'.\n"
    "\n"
    "The log (--log) has a row per packet and direction, in the order of arrival:\n"
    "  direction,number,time_ms,verdict,delay_ms\n"
    "Verdicts: forwarded, lost, over-limit, blackout (in a hole of the trace, or a --blackhole), waiting (at the end), "
    "with duplicate+, corrupted+ or reordered+ in front where they apply. A thread of its own writes it, so a slow "
    "disk delays no packet.\n"
    "\n"
    "While it runs, --control takes new impairments, by UDP from this machine alone, each datagram a line:\n"
    "  both WORDS   both directions from now on, for packets that come from now on; without words: a perfect network\n"
    "  up WORDS     from client to server alone; down WORDS: from server to client\n"
    "  status       changes nothing\n"
    "The answer is a line with the impairments that hold, or \"error: \" and what would be accepted. Trace and "
    "blackholes "
    "stay. Each change is printed.\n"
    "\n"
    "Up to 256 clients at once, if the limit on open files allows it (a warning says so), each forgotten after 60 s "
    "without a datagram. Ctrl-C or SIGTERM ends it with totals.\n"
    "\n"
    "Examples, each with --listen 127.0.0.1:47801 --upstream 127.0.0.1:47800:\n"
    "  forcebound-relay ... --netem 'delay 50ms 10ms loss 5%'\n"
    "  forcebound-relay ... --netem-up 'loss gemodel 1% 10%' --seed 7\n"
    "  forcebound-relay ... --trace 5g-rural-n8.csv --log packets.csv\n"
    "  forcebound-relay ... --blackhole down:10-70 --blackhole both:90-95\n"
    "  forcebound-relay ... --control 127.0.0.1:47802, then in bash:\n"
    "    echo both delay 100ms >/dev/udp/127.0.0.1/47802\n"
    "\n";

struct Texts {
  std::string listen;
  std::string upstream;
  std::string netem;
  std::string netem_up;
  std::string netem_down;
  std::vector<std::string> blackholes;
  std::string control;
};

void declare(CLI::App& app, Options& options, Texts& texts) {
  program::set_up(app, kProgram);
  app.description(kAbout);
  app.add_option("--listen", texts.listen, "where clients send to; port 0 takes a free one")
      ->required()
      ->type_name("HOST:PORT");
  app.add_option("--upstream", texts.upstream, "where the server is")->required()->type_name("HOST:PORT");
  app.add_option("--netem", texts.netem, "impairments of both directions, in the words of 'tc ... netem'")
      ->type_name("\"WORDS\"");
  app.add_option("--netem-up", texts.netem_up, "instead of --netem, from client to server")->type_name("\"WORDS\"");
  app.add_option("--netem-down", texts.netem_down, "instead of --netem, from server to client")->type_name("\"WORDS\"");
  app.add_option(
         "--blackhole", texts.blackholes,
         "direction (up, down or both) that is dead from FROM to TO, in seconds since the start; may be repeated")
      ->type_name("WAY:FROM-TO");
  app.add_option("--control", texts.control, "take new impairments there while it runs; an address of this machine")
      ->check(program::not_empty())
      ->type_name("HOST:PORT");
  app.add_option("--trace", options.trace, "recorded network to play")->check(program::not_empty())->type_name("FILE");
  app.add_option("--seed", options.seed, "decides every random choice; default: a new one, printed")
      ->check(program::whole_within(0))
      ->type_name("N");
  app.add_option("--log", options.log, "write each packet's fate to this file")
      ->check(program::not_empty())
      ->type_name("FILE.csv");
  app.footer("WORDS:\n" + std::string(netem::netem_help()) + "\n" + std::string(kMore) +
             program::exit_codes_without({program::kNotPassive, program::kNeverConnected, program::kDriverCrashed}));
}

}  // namespace

Options read_command_line(int argc, const char* const* argv, std::uint64_t random_seed) {
  Options options;
  options.seed = random_seed;
  Texts texts;
  CLI::App app;
  declare(app, options, texts);
  program::parse(app, argc, argv);
  program::expect_apart({"--log", options.log}, {{"--trace", options.trace}});
  options.listen = program::value_of("--listen", [&] { return net::parse_endpoint(texts.listen); });
  options.upstream = program::value_of("--upstream", [&] { return net::parse_peer(texts.upstream); });
  if (!texts.control.empty()) {
    options.control = program::value_of("--control", [&] { return net::parse_endpoint(texts.control); });
  }
  for (const std::string& text : texts.blackholes) {
    const BlackholeOption blackhole = program::value_of("--blackhole", [&] { return parse_blackhole(text); });
    if (blackhole.up) options.up_blackholes.push_back(blackhole.when);
    if (blackhole.down) options.down_blackholes.push_back(blackhole.when);
  }
  const auto both = program::value_of("--netem", [&] { return netem::parse_netem(texts.netem); });
  const bool own_up = app.count("--netem-up") != 0;
  const bool own_down = app.count("--netem-down") != 0;
  options.up = own_up ? program::value_of("--netem-up", [&] { return netem::parse_netem(texts.netem_up); }) : both;
  options.down =
      own_down ? program::value_of("--netem-down", [&] { return netem::parse_netem(texts.netem_down); }) : both;
  options.up_words = netem::with_units(own_up ? texts.netem_up : texts.netem);
  options.down_words = netem::with_units(own_down ? texts.netem_down : texts.netem);
  return options;
}

}  // namespace forcebound::relay
