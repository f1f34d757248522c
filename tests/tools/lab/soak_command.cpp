#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/soak/soak.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"
#include "tests/tools/sim/environment.hpp"

namespace forcebound::lab {
namespace {

using SteadyTime = std::chrono::steady_clock;

std::atomic<bool> interrupted{false};
void interrupt(int /*signal*/) { interrupted = true; }

constexpr std::string_view kDrawn = "drawn";

struct SoakOptions {
  std::uint64_t seeds = 1000;
  std::uint64_t from = 1;
  double minutes = 0;
  std::string law{kDrawn};
  bool tools = false;

  [[nodiscard]] SoakTip tip() const { return tools ? SoakTip::tool : SoakTip::point; }

  /// The command that runs one case again.
  [[nodiscard]] std::string command_of(std::uint64_t seed, const std::string& its_law) const {
    return std::string("forcebound-lab soak ") + (tools ? "--tools " : "") + "--law " + its_law + " --seeds 1 --from " +
           std::to_string(seed);
  }
};

/// Results of all seeds so far.
class Tally {
 public:
  void add(std::uint64_t seed, const std::string& law, const SoakResult& result) {
    ++seeds_;
    sum_.virtual_s += result.virtual_s;
    sum_.ticks += result.ticks;
    sum_.recomputed += result.recomputed;
    sum_.late_ticks += result.late_ticks;
    sum_.released += result.released;
    sum_.withdrawn += result.withdrawn;
    sum_.reconnects += result.reconnects;
    sum_.lost += result.lost;
    const char* const truth = result.beyond_bounds ? "beyond the facts' bounds" : "within the facts' bounds";
    for (Share* share : {&laws_[law], &environments_[result.environment], &truths_[law + ", " + truth]}) {
      ++share->seeds;
      share->promised += result.passive ? 1 : 0;
      share->least_P_J = std::min(share->least_P_J, result.least_P_J);
    }
    if (result.least_P_J < sum_.least_P_J) {
      sum_.least_P_J = result.least_P_J;
      worst_seed_ = seed;
      worst_law_ = law;
    }
  }

  [[nodiscard]] double elapsed_s() const { return std::chrono::duration<double>(SteadyTime::now() - begin_).count(); }

  /// Short, to leave room for the remaining time.
  [[nodiscard]] std::string short_line() const {
    return text::counted(seeds_, "seed") + ", least P " + results::millijoules(sum_.least_P_J) + " mJ";
  }

  [[nodiscard]] std::string line() const {
    return text::counted(seeds_, "seed") + ", " + text::fixed(sum_.virtual_s, 0) + " virtual s, " +
           text::fixed(sum_.virtual_s / elapsed_s(), 0) + " times real time, least P " +
           results::millijoules(sum_.least_P_J) + " mJ";
  }

  void print(const SoakOptions& options) const {
    std::printf("%s\n", line().c_str());
    if (worst_seed_ != 0) std::printf("  least P: %s\n", options.command_of(worst_seed_, worst_law_).c_str());
    const std::pair<const char*, std::uint64_t> counts[] = {{"ticks checked", sum_.ticks},
                                                            {"ledgers recomputed", sum_.recomputed},
                                                            {"late ticks", sum_.late_ticks},
                                                            {"forces released by the device", sum_.released},
                                                            {"forces withdrawn, commanded too late", sum_.withdrawn},
                                                            {"datagrams lost", sum_.lost},
                                                            {"sessions lost and regained", sum_.reconnects}};
    text::Table table({{"events"}, {"count"}});
    for (const auto& [what, count] : counts) table.add({what, std::to_string(count)});
    std::printf("\n%s\n%s\n%s\n%s", table.to_text().c_str(), table_of("law", laws_).c_str(),
                table_of("law, and where the device's truth lies", truths_).c_str(),
                table_of("environment", environments_).c_str());
  }

 private:
  struct Share {
    std::uint64_t seeds = 0;
    std::uint64_t promised = 0;  ///< of them with a law that guarantees P >= 0 there
    double least_P_J = 0;
  };
  using Shares = std::map<std::string, Share>;

  static std::string table_of(const char* of_what, const Shares& shares) {
    text::Table table({{of_what}, {"seeds"}, {"promised"}, {"least P", "mJ"}});
    for (const auto& [name, share] : shares) {
      table.add(
          {name, std::to_string(share.seeds), std::to_string(share.promised), results::millijoules(share.least_P_J)});
    }
    return table.to_text();
  }

  SteadyTime::time_point begin_ = SteadyTime::now();
  std::uint64_t seeds_ = 0;
  SoakResult sum_;
  std::uint64_t worst_seed_ = 0;
  std::string worst_law_;
  Shares laws_;
  Shares environments_;
  Shares truths_;  ///< by law, and whether the facts' bounds held the truth
};

[[noreturn]] void fail(const SoakOptions& options, std::uint64_t seed, const std::string& law,
                       const SoakResult& result) {
  std::printf("%s", draw_soak_case(seed, law, options.tip()).description().c_str());
  throw std::runtime_error("seed " + std::to_string(seed) + ": " + result.broken +
                           "\nagain: " + options.command_of(seed, law));
}

void run(const SoakOptions& options) {
  if (options.tools && options.law != kDrawn) {
    program::value_of("--tools", [&] { (void)draw_soak_case(options.from, options.law, options.tip()); });
  }
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  const bool live = isatty(STDERR_FILENO) != 0;
  constexpr double kBetween_s = 10;
  double next_s = kBetween_s;
  Tally tally;
  program::Progress progress;
  std::printf("seeds from %llu, %s\n", static_cast<unsigned long long>(options.from), options.law.c_str());
  for (std::uint64_t i = 0; !interrupted; ++i) {
    if (options.minutes > 0 ? tally.elapsed_s() >= options.minutes * 60 : i == options.seeds) break;
    const std::uint64_t seed = options.from + i;
    const std::string law = options.law == kDrawn ? law_of(seed, options.tip()) : options.law;
    const SoakResult result = soak(seed, law, options.tip());
    tally.add(seed, law, result);
    if (!result.broken.empty()) {
      progress.clear();
      fail(options, seed, law, result);
    }
    const double share = options.minutes > 0 ? tally.elapsed_s() / (options.minutes * 60)
                                             : static_cast<double>(i + 1) / static_cast<double>(options.seeds);
    progress.report(share, tally.short_line());
    if (live || tally.elapsed_s() < next_s) continue;
    next_s = tally.elapsed_s() + kBetween_s;
    std::fprintf(stderr, "%s\n", tally.line().c_str());
  }
  progress.clear();
  tally.print(options);
}

}  // namespace

void add_soak(CLI::App& app) {
  auto options = std::make_shared<SoakOptions>();
  CLI::App* command =
      app.add_subcommand("soak", "Hostile runs in virtual time, each drawn from its seed and checked on every tick");
  CLI::Option* const seeds = command->add_option("--seeds", options->seeds, "how many cases");
  seeds->check(program::whole_within(1, 1'000'000'000))->type_name("N")->capture_default_str();
  command->add_option("--from", options->from, "the first seed")
      ->check(program::whole_within(0))
      ->type_name("SEED")
      ->capture_default_str();
  command->add_option("--minutes", options->minutes, "instead of --seeds: as many as fit into this time")
      ->check(program::number_above_zero())
      ->excludes(seeds)
      ->type_name("MINUTES");
  std::vector<std::string> laws = baselines::shipped_laws().names();
  laws.emplace_back(kDrawn);
  command->add_option("--law", options->law, "for all seeds; drawn: from each seed one of all laws")
      ->type_name("LAW")
      ->check(program::one_of("law", laws))
      ->capture_default_str();
  command->add_flag("--tools", options->tools,
                    "a tool that has a shape in the hand: peg_in_hole or blade on a device of six axes, which "
                    "environments push and turn");
  command->footer(
      "From each seed: law, device, encoder, actuator, friction, latency, hold time, late ticks, the law's memory, "
      "hostile environment, restless hand, both ways of the network, blackouts, stalls, server kills, the server's "
      "clock, local or remote rendering of a scene that is handed over, another one or damaged; and how far the device "
      "is from its facts, within their bounds or beyond: stamps, latency, release, frames of its bus, writes, clock, "
      "counts, damping, friction, torque, lag.\n"
      "\n"
      "On each tick: everything finite, |f| <= f_max, and the law's guarantees: direction kept, P >= -1e-9 J and the "
      "ledger never above P (fba-exact where the facts' bounds hold the truth, others with the ideal device that half "
      "of their seeds have), the ledger equal to its recomputation in long double; in the end, counters add up and the "
      "session is back. The first failure ends it (exit code 1), with all drawn settings and the command that runs it "
      "again. Beyond the bounds the table says by how much each law leaks.\n"
      "\n"
      "Environments:\n" +
      sim::environments_help() +
      "\nExample:\n"
      "  forcebound-lab soak --seeds 1000 --law fba-exact");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
