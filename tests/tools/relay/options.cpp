#include "tests/tools/relay/options.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <sstream>
#include <string_view>
#include <utility>

#include "forcebound/text/terminal.hpp"
#include "tests/tools/relay/blackhole.hpp"

namespace forcebound::relay {
namespace {

constexpr std::string_view kName = "forcebound-relay";
constexpr int kWrongUse = 2;

constexpr std::string_view kAbout =
    "Emulates a network between forcebound-client and forcebound-server:\n"
    "delay, jitter, loss, bursts, duplicates, corruption, reordering, a slow line, or a\n"
    "recorded network.\n"
    "\n"
    "Point the client at --listen; the relay talks to the server at --upstream.\n";

constexpr std::string_view kMore = R"(
Traces (--trace), for both directions, starting with the relay and over again
after their end:
  CSV with the header send_time_ms,rtt_ms: half of the round trip each way,
  interpolated; a hole of more than 1 s is a blackout, and what is sent in it is
  lost. Adds to the words of --netem. The queue then holds 100000 packets unless
  limit says otherwise.
  mahimahi (one whole millisecond per line): each line is an opportunity to
  deliver 1500 bytes.

Differences from tc: all randomness of a direction comes from one generator
seeded by --seed, which is printed at start, so the same seed gives the same fate
to the same packets; netem draws from the kernel's own. A slot never exceeds its
bytes, except by a packet that is larger than a slot. loss with a correlation
loses far less (or more) than its percentage, as in netem, and is warned about:
for bursts use 'loss gemodel'.

The log (--log) has a row per packet and direction, in the order of arrival:
  direction,number,time_ms,verdict,delay_ms
Verdicts: forwarded, lost, over-limit, blackout (in a hole of the trace, or a
--blackhole), waiting (at the end), with duplicate+, corrupted+ or reordered+ in
front where they apply. It is written aside, so a slow disk delays no packet.

Up to 256 clients at once, each forgotten after 60 s without a datagram. Ctrl-C or
SIGTERM ends it with totals.

Examples, each with --listen 127.0.0.1:47801 --upstream 127.0.0.1:47800:
  forcebound-relay ... --netem 'delay 50ms 10ms loss 5%'
  forcebound-relay ... --netem-up 'loss gemodel 1% 10%' --seed 7
  forcebound-relay ... --trace 5g-rural-n8.csv --log packets.csv
  forcebound-relay ... --blackhole down:10-70 --blackhole both:90-95

Exit code: 0 ended by a signal, 1 failed, 2 wrong use.
)";

struct Texts {
  std::string listen;
  std::string upstream;
  std::string netem;
  std::string netem_up;
  std::string netem_down;
  std::vector<std::string> blackholes;
  std::string seed;
};

std::uint64_t parse_seed(const std::string& text) {
  std::uint64_t seed = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, seed);
  if (error != std::errc{} || stopped != end)
    throw std::invalid_argument("'" + text + "' is not a seed: expected a whole number from 0 to 18446744073709551615");
  return seed;
}

/// Runs a parser; its error ends the command line, naming the option.
template <class Parser>
auto read_value(std::string_view option, Parser parse) {
  try {
    return parse();
  } catch (const std::invalid_argument& error) {
    throw CommandLineEnd{kWrongUse, std::string(kName) + ": " + std::string(option) + ": " + error.what() + "\n"};
  }
}

void declare(CLI::App& app, Options& options, Texts& texts) {
  app.formatter_fn([](const CLI::App* of, std::string name, CLI::AppFormatMode mode) {
    return text::wrapped_help(CLI::Formatter().make_help(of, std::move(name), mode));
  });
  app.set_version_flag("--version", std::string(kName) + " " FORCEBOUND_VERSION);
  app.add_option("--listen", texts.listen, "Where clients send to; port 0 takes any free one")
      ->required()
      ->type_name("HOST:PORT");
  app.add_option("--upstream", texts.upstream, "Where the server is")->required()->type_name("HOST:PORT");
  app.add_option("--netem", texts.netem, "Impairments of both directions, in the words of 'tc ... netem'")
      ->type_name("\"WORDS\"");
  app.add_option("--netem-up", texts.netem_up, "Instead of --netem, from client to server")->type_name("\"WORDS\"");
  app.add_option("--netem-down", texts.netem_down, "Instead of --netem, from server to client")->type_name("\"WORDS\"");
  app.add_option(
         "--blackhole", texts.blackholes,
         "A direction (up, down or both) that is dead from FROM to TO, in seconds since the start; may be repeated")
      ->type_name("WAY:FROM-TO");
  app.add_option("--trace", options.trace, "A recorded network to play")->type_name("FILE");
  app.add_option("--seed", texts.seed, "Decides every random choice; default: a new one, printed")->type_name("N");
  app.add_option("--log", options.log, "Log of each packet's fate, as CSV")->type_name("FILE.csv");
  app.footer("WORDS:\n" + std::string(netem::netem_help()) + "\n" + std::string(kMore));
}

}  // namespace

Options read_command_line(int argc, const char* const* argv, std::uint64_t random_seed) {
  Options options;
  options.seed = random_seed;
  Texts texts;
  CLI::App app{std::string(kAbout), std::string(kName)};
  declare(app, options, texts);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out;
    std::ostringstream problem;
    if (app.exit(error, out, problem) == 0) throw CommandLineEnd{0, out.str()};
    // A mistyped option explains why another is missing, so it is reported first.
    const auto unknown = app.remaining();
    const std::string what = unknown.empty() ? error.what() : CLI::ExtrasError(unknown).what();
    throw CommandLineEnd{kWrongUse, std::string(kName) + ": " + what + "; see --help\n"};
  }
  options.listen = read_value("--listen", [&] { return net::parse_endpoint(texts.listen); });
  options.upstream = read_value("--upstream", [&] { return net::parse_peer(texts.upstream); });
  if (!texts.seed.empty()) options.seed = read_value("--seed", [&] { return parse_seed(texts.seed); });
  for (const std::string& text : texts.blackholes) {
    const BlackholeOption blackhole = read_value("--blackhole", [&] { return parse_blackhole(text); });
    if (blackhole.up) options.up_blackholes.push_back(blackhole.when);
    if (blackhole.down) options.down_blackholes.push_back(blackhole.when);
  }
  const auto both = read_value("--netem", [&] { return netem::parse_netem(texts.netem); });
  const bool own_up = app.count("--netem-up") != 0;
  const bool own_down = app.count("--netem-down") != 0;
  options.up = own_up ? read_value("--netem-up", [&] { return netem::parse_netem(texts.netem_up); }) : both;
  options.down = own_down ? read_value("--netem-down", [&] { return netem::parse_netem(texts.netem_down); }) : both;
  options.up_words = own_up ? texts.netem_up : texts.netem;
  options.down_words = own_down ? texts.netem_down : texts.netem;
  return options;
}

}  // namespace forcebound::relay
