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

#include "forcebound/control/law_registry.hpp"
#include "tests/lab/above_zero.hpp"
#include "tests/lab/commands.hpp"
#include "tests/lab/soak/soak.hpp"
#include "tests/lab/soak/soak_case.hpp"

namespace forcebound::lab {
namespace {

using SteadyTime = std::chrono::steady_clock;

std::atomic<bool> interrupted{false};
void interrupt(int /*signal*/) { interrupted = true; }

struct SoakOptions {
  std::uint64_t seeds = 1000;
  std::uint64_t from = 1;
  double minutes = 0;
  std::string law = "fba-exact";
};

/// What all seeds so far came to.
class Tally {
 public:
  void add(std::uint64_t seed, const SoakResult& result) {
    ++seeds_;
    sum_.virtual_s += result.virtual_s;
    sum_.ticks += result.ticks;
    sum_.recomputed += result.recomputed;
    sum_.late_ticks += result.late_ticks;
    sum_.released += result.released;
    sum_.withdrawn += result.withdrawn;
    sum_.reconnects += result.reconnects;
    sum_.lost += result.lost;
    Environment& environment = environments_[result.environment];
    ++environment.seeds;
    environment.worst_P_J = std::min(environment.worst_P_J, result.worst_P_J);
    if (result.worst_P_J < sum_.worst_P_J) {
      sum_.worst_P_J = result.worst_P_J;
      worst_seed_ = seed;
    }
  }

  [[nodiscard]] double elapsed_s() const { return std::chrono::duration<double>(SteadyTime::now() - begin_).count(); }

  [[nodiscard]] std::string line() const {
    char text[160];
    std::snprintf(text, sizeof text, "%llu seeds, %.0f virtual s, %.0f times real time, worst P %.3g J",
                  static_cast<unsigned long long>(seeds_), sum_.virtual_s, sum_.virtual_s / elapsed_s(),
                  sum_.worst_P_J);
    return text;
  }

  void print(const std::string& law) const {
    const auto count = [](const char* what, std::uint64_t n) {
      std::printf("  %-40s %12llu\n", what, static_cast<unsigned long long>(n));
    };
    std::printf("%s: %s\n", law.c_str(), line().c_str());
    if (worst_seed_ != 0) {
      std::printf("  worst: forcebound-lab soak --law %s --seeds 1 --from %llu\n", law.c_str(),
                  static_cast<unsigned long long>(worst_seed_));
    }
    count("ticks checked", sum_.ticks);
    count("ledgers recomputed", sum_.recomputed);
    count("late ticks", sum_.late_ticks);
    count("forces let go of by the device", sum_.released);
    count("forces withdrawn, commanded too late", sum_.withdrawn);
    count("datagrams lost", sum_.lost);
    count("sessions lost and regained", sum_.reconnects);
    std::printf("\n  %-20s %8s %14s\n", "environment", "seeds", "worst P [J]");
    for (const auto& [name, environment] : environments_) {
      std::printf("  %-20s %8llu %14.3g\n", name.c_str(), static_cast<unsigned long long>(environment.seeds),
                  environment.worst_P_J);
    }
  }

 private:
  struct Environment {
    std::uint64_t seeds = 0;
    double worst_P_J = 0;
  };
  SteadyTime::time_point begin_ = SteadyTime::now();
  std::uint64_t seeds_ = 0;
  SoakResult sum_;
  std::uint64_t worst_seed_ = 0;
  std::map<std::string, Environment> environments_;
};

[[noreturn]] void fail(std::uint64_t seed, const SoakOptions& options, const SoakResult& result) {
  std::printf("%s", draw_soak_case(seed, options.law).description().c_str());
  throw std::runtime_error("seed " + std::to_string(seed) + ": " + result.broken +
                           "\nagain: forcebound-lab soak --law " + options.law + " --seeds 1 --from " +
                           std::to_string(seed));
}

void run(const SoakOptions& options) {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  const bool live = isatty(STDERR_FILENO) != 0;
  const double between_s = live ? 0.2 : 10;
  double next_s = between_s;
  Tally tally;
  std::printf("seeds from %llu, %s\n", static_cast<unsigned long long>(options.from), options.law.c_str());
  for (std::uint64_t i = 0; !interrupted; ++i) {
    if (options.minutes > 0 ? tally.elapsed_s() >= options.minutes * 60 : i == options.seeds) break;
    const std::uint64_t seed = options.from + i;
    const SoakResult result = soak(seed, options.law);
    tally.add(seed, result);
    if (!result.broken.empty()) {
      if (live) std::fputs("\n", stderr);
      fail(seed, options, result);
    }
    if (tally.elapsed_s() < next_s) continue;
    next_s = tally.elapsed_s() + between_s;
    std::fprintf(stderr, live ? "\r%s\033[K" : "%s\n", tally.line().c_str());
  }
  if (live) std::fputs("\r\033[K", stderr);
  tally.print(options.law);
}

}  // namespace

void add_soak(CLI::App& app) {
  auto options = std::make_shared<SoakOptions>();
  CLI::App* command =
      app.add_subcommand("soak", "Hostile runs in virtual time, each drawn from its seed and checked on every tick");
  command->add_option("--seeds", options->seeds, "how many")->check(above_zero())->capture_default_str();
  command->add_option("--from", options->from, "the first seed")->capture_default_str()->type_name("SEED");
  command->add_option("--minutes", options->minutes, "as many seeds as this takes instead")
      ->check(above_zero())
      ->type_name("M");
  command->add_option("--law", options->law, "fba-exact must stay passive; the others show what they leak")
      ->check(CLI::IsMember(control::shipped_laws().names()))
      ->capture_default_str();
  command->footer(
      "From each seed: device, encoder, actuator, friction, latency, hold time, late ticks, law's memory, hostile\n"
      "environment, restless hand, both ways of the network, blackouts, stalls, server kills, the server's clock.\n"
      "On each tick: everything finite, |f| <= f_max, direction kept, P >= -1e-9 J and the ledger never above P\n"
      "(fba-exact), the ledger equal to its recomputation in long double; in the end, counters add up and the session\n"
      "is back. The first failure ends it (exit code 1), with all that was drawn and the command that runs it again.");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
