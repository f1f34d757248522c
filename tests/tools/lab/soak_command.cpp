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
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/tools/lab/above_zero.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/progress.hpp"
#include "tests/tools/lab/soak/soak.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"

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
    for (Share* share : {&laws_[law], &environments_[result.environment]}) {
      ++share->seeds;
      share->promised += result.passive ? 1 : 0;
      share->worst_P_J = std::min(share->worst_P_J, result.worst_P_J);
    }
    if (result.worst_P_J < sum_.worst_P_J) {
      sum_.worst_P_J = result.worst_P_J;
      worst_seed_ = seed;
      worst_law_ = law;
    }
  }

  [[nodiscard]] double elapsed_s() const { return std::chrono::duration<double>(SteadyTime::now() - begin_).count(); }

  /// Short, to leave room for the remaining time.
  [[nodiscard]] std::string short_line() const {
    char text[80];
    std::snprintf(text, sizeof text, "%llu seeds, worst P %.3g J", static_cast<unsigned long long>(seeds_),
                  sum_.worst_P_J);
    return text;
  }

  [[nodiscard]] std::string line() const {
    char text[160];
    std::snprintf(text, sizeof text, "%llu seeds, %.0f virtual s, %.0f times real time, worst P %.3g J",
                  static_cast<unsigned long long>(seeds_), sum_.virtual_s, sum_.virtual_s / elapsed_s(),
                  sum_.worst_P_J);
    return text;
  }

  void print() const {
    const auto count = [](const char* what, std::uint64_t n) {
      std::printf("  %-40s %12llu\n", what, static_cast<unsigned long long>(n));
    };
    std::printf("%s\n", line().c_str());
    if (worst_seed_ != 0) {
      std::printf("  worst: forcebound-lab soak --law %s --seeds 1 --from %llu\n", worst_law_.c_str(),
                  static_cast<unsigned long long>(worst_seed_));
    }
    count("ticks checked", sum_.ticks);
    count("ledgers recomputed", sum_.recomputed);
    count("late ticks", sum_.late_ticks);
    count("forces released by the device", sum_.released);
    count("forces withdrawn, commanded too late", sum_.withdrawn);
    count("datagrams lost", sum_.lost);
    count("sessions lost and regained", sum_.reconnects);
    print("law", laws_);
    print("environment", environments_);
  }

 private:
  struct Share {
    std::uint64_t seeds = 0;
    std::uint64_t promised = 0;  ///< of them with a law that guarantees P >= 0 there
    double worst_P_J = 0;
  };
  using Shares = std::map<std::string, Share>;

  static void print(const char* of_what, const Shares& shares) {
    std::printf("\n  %-20s %8s %10s %14s\n", of_what, "seeds", "promised", "worst P [J]");
    for (const auto& [name, share] : shares) {
      std::printf("  %-20s %8llu %10llu %14.3g\n", name.c_str(), static_cast<unsigned long long>(share.seeds),
                  static_cast<unsigned long long>(share.promised), share.worst_P_J);
    }
  }

  SteadyTime::time_point begin_ = SteadyTime::now();
  std::uint64_t seeds_ = 0;
  SoakResult sum_;
  std::uint64_t worst_seed_ = 0;
  std::string worst_law_;
  Shares laws_;
  Shares environments_;
};

[[noreturn]] void fail(std::uint64_t seed, const std::string& law, const SoakResult& result) {
  std::printf("%s", draw_soak_case(seed, law).description().c_str());
  throw std::runtime_error("seed " + std::to_string(seed) + ": " + result.broken +
                           "\nagain: forcebound-lab soak --law " + law + " --seeds 1 --from " + std::to_string(seed));
}

void run(const SoakOptions& options) {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  const bool live = isatty(STDERR_FILENO) != 0;
  constexpr double kBetween_s = 10;
  double next_s = kBetween_s;
  Tally tally;
  Progress progress;
  std::printf("seeds from %llu, %s\n", static_cast<unsigned long long>(options.from), options.law.c_str());
  for (std::uint64_t i = 0; !interrupted; ++i) {
    if (options.minutes > 0 ? tally.elapsed_s() >= options.minutes * 60 : i == options.seeds) break;
    const std::uint64_t seed = options.from + i;
    const std::string law = options.law == kDrawn ? law_of(seed) : options.law;
    const SoakResult result = soak(seed, law);
    tally.add(seed, law, result);
    if (!result.broken.empty()) {
      progress.clear();
      fail(seed, law, result);
    }
    const double share = options.minutes > 0 ? tally.elapsed_s() / (options.minutes * 60)
                                             : static_cast<double>(i + 1) / static_cast<double>(options.seeds);
    progress.tell(share, tally.short_line());
    if (live || tally.elapsed_s() < next_s) continue;
    next_s = tally.elapsed_s() + kBetween_s;
    std::fprintf(stderr, "%s\n", tally.line().c_str());
  }
  progress.clear();
  tally.print();
}

}  // namespace

void add_soak(CLI::App& app) {
  auto options = std::make_shared<SoakOptions>();
  CLI::App* command =
      app.add_subcommand("soak", "Hostile runs in virtual time, each drawn from its seed and checked on every tick");
  command->add_option("--seeds", options->seeds, "how many cases")->check(above_zero())->capture_default_str();
  command->add_option("--from", options->from, "the first seed")->capture_default_str()->type_name("SEED");
  command->add_option("--minutes", options->minutes, "instead of --seeds: as many as fit into this time")
      ->check(above_zero())
      ->type_name("M");
  std::vector<std::string> laws = baselines::shipped_laws().names();
  laws.emplace_back(kDrawn);
  command->add_option("--law", options->law, "for all seeds; drawn: from each seed one of all laws")
      ->type_name("LAW")
      ->check(CLI::IsMember(laws).description(""))
      ->capture_default_str();
  command->footer(
      "From each seed: law, device, encoder, actuator, friction, latency, hold time, late\n"
      "ticks, the law's memory, hostile environment, restless hand, both ways of the\n"
      "network, blackouts, stalls, server kills, the server's clock.\n"
      "On each tick: everything finite, |f| <= f_max, and the law's guarantees: direction\n"
      "kept, P >= -1e-9 J and the ledger never above P (fba-exact always, others with the\n"
      "ideal device that half of their seeds have), the ledger equal to its recomputation\n"
      "in long double; in the end, counters add up and the session is back. The first\n"
      "failure ends it (exit code 1), with all drawn settings and the command that runs it\n"
      "again.");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
