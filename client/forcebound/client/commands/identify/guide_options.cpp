#include "forcebound/client/commands/identify/guide_options.hpp"

#include <CLI/CLI.hpp>

#include "forcebound/program/command_line.hpp"

namespace forcebound::client::commands::identify {

void add_guide_options(CLI::App& command, GuideOptions& options, const char* seeded) {
  command.add_option("--force-share", options.guide.force_share, "of the device's largest force")
      ->check(program::number_within(0.01, 1))
      ->type_name("SHARE")
      ->capture_default_str();
  command.add_option("--speed", options.guide.speed_m_per_s_max, "fastest motion of the tip, in m/s")
      ->check(program::number_within(0.01, 5))
      ->type_name("M_PER_S")
      ->capture_default_str();
  command.add_option("--radius", options.guide.radius_m, "how far the tip moves each way, in m")
      ->check(program::number_within(0.002, 1))
      ->type_name("M")
      ->capture_default_str();
  command.add_option("--confidence", options.confidence, "that all bounds hold, together")
      ->check(program::number_within(0.5, 0.9999))
      ->type_name("SHARE")
      ->capture_default_str();
  command.add_option("--seed", options.guide.seed, seeded)
      ->check(program::whole_within(0))
      ->type_name("SEED")
      ->capture_default_str();
}

}  // namespace forcebound::client::commands::identify
