#include "forcebound/client/app/options.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::client {
namespace {

constexpr std::string_view kAbout =
    "The device side of Forcebound: reads a haptic device at 1 kHz, sends its motion to\n"
    "a server, and applies the forces that come back, bounded so that the device never\n"
    "returns more energy than its damping takes, however late they are.\n";

constexpr std::string_view kMore = R"(
A force is applied as it is while the motion it answers is younger than --hold,
then fades, and is zero from --drop on. On a terminal a line shows how it goes; at
the end, also after Ctrl-C, a summary is printed. NO_COLOR=1 leaves out colours.

Example, with forcebound-server --scene sphere running on this machine:
  forcebound-client --server 127.0.0.1:47800 --device omni \
    --operator trace-sphere --law fba-more --duration 20
Exit code: 0 done, 1 failed, 2 wrong use.
)";

/// A number from 0 to 1e9, so that no change of unit overflows.
const CLI::Validator kNotNegative(
    [](const std::string& text) {
      constexpr double kMost = 1e9;
      double value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      const bool number = error == std::errc{} && end == text.data() + text.size();
      return number && value >= 0 && value <= kMost ? "" : "expected a number from 0 to 1e9, got '" + text + "'";
    },
    "");

const CLI::Validator kWhole(
    [](const std::string& text) {
      unsigned long long value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      const bool whole = error == std::errc{} && end == text.data() + text.size();
      return whole ? "" : "expected a whole number from 0 to 18446744073709551615, got '" + text + "'";
    },
    "");

void check_server(const std::string& server) {
  try {
    static_cast<void>(net::parse_peer(server));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("--server: ") + error.what());
  }
}

[[noreturn]] void end_as_wrong_use(const std::string& problem) {
  std::fprintf(stderr, "forcebound-client: %s; see --help\n", problem.c_str());
  std::exit(2);
}

}  // namespace

Options parse_options(int argc, char** argv) {
  Options options;
  double hold_ms = time::to_seconds(options.policy.hold) * 1e3;
  double drop_ms = time::to_seconds(options.policy.drop) * 1e3;
  std::string memory = "capped";
  const control::LawRegistry laws = baselines::shipped_laws();
  const device::DeviceRegistry devices = device::DeviceRegistry::standard();

  CLI::App app{std::string(kAbout), "forcebound-client"};
  app.formatter_fn([](const CLI::App* of, std::string name, CLI::AppFormatMode mode) {
    return text::wrapped_help(CLI::Formatter().make_help(of, std::move(name), mode));
  });
  app.footer("Laws (--law):\n" + laws.help() + "\n" + devices.help() + std::string(kMore));
  app.set_version_flag("--version", "forcebound-client " FORCEBOUND_VERSION);
  app.add_option("--server", options.server, "the server, or a relay in front of it")
      ->required()
      ->type_name("HOST:PORT");
  app.add_option("--scene", options.scene, "scene to request; default: the server's")->type_name("NAME");
  app.add_option("--device", options.device.device, "see below")->type_name("NAME|FILE");
  app.add_option("--operator", options.device.hand, "see below")->type_name("SPEC");
  app.add_option("--law", options.law, "see below")
      ->check(CLI::IsMember(laws.names()).description(""))
      ->type_name("LAW")
      ->capture_default_str();
  app.add_option("--law-parameters", options.law_parameters, "a table for each law: [vc], coupling_N_per_m = 40000")
      ->type_name("FILE.toml");
  app.add_option("--law-help", options.law_help,
                 "explain this law, its parameters and their values for --device, and end")
      ->check(CLI::IsMember(laws.names()).description(""))
      ->type_name("LAW");
  app.add_option("--memory", memory, "energy that fba-exact may store: as much as the largest force can need, or all")
      ->check(CLI::IsMember({"capped", "full"}))
      ->capture_default_str();
  app.add_option("--duration", options.duration_s, "seconds; 0: until interrupted")
      ->check(kNotNegative)
      ->capture_default_str()
      ->type_name("SECONDS");
  CLI::Option* seed = app.add_option("--seed", options.seed, "seed of the handshake's nonces; default: random")
                          ->check(kWhole)
                          ->type_name("N");
  app.add_option("--record", options.record, "write every tick and force to this MCAP file")->type_name("FILE.mcap");
  app.add_option("--summary", options.summary, "write the summary to this file as well")->type_name("FILE.json");
  app.add_option("--hold", hold_ms, "age up to which a force is applied unchanged")
      ->check(kNotNegative)
      ->capture_default_str()
      ->type_name("MS");
  app.add_option("--drop", drop_ms, "age from which a force is replaced by zero")
      ->check(kNotNegative)
      ->capture_default_str()
      ->type_name("MS");
  app.add_flag("--once", options.once, "end if the server refuses or does not answer for 5 s, instead of retrying");
  app.add_flag("--quiet", options.quiet, "no live line");
  try {
    app.parse(argc, argv);
    options.policy = {.hold = time::from_seconds(hold_ms * 1e-3), .drop = time::from_seconds(drop_ms * 1e-3)};
    options.policy.validate();
    options.law_options.memory = memory == "full" ? control::EnergyMemory::full : control::EnergyMemory::capped;
    check_server(options.server);
    // Not the nonce of the previous run: a server that still has that session would take this run for it.
    if (seed->count() == 0) options.seed = std::random_device{}();
  } catch (const CLI::Success& success) {
    std::exit(app.exit(success));
  } catch (const CLI::RequiredError& missing) {
    // A mistyped option explains why another is missing, so it is reported first.
    const auto unknown = app.remaining();
    if (!unknown.empty() || options.law_help.empty())
      end_as_wrong_use(unknown.empty() ? missing.what() : CLI::ExtrasError(unknown).what());
  } catch (const std::exception& error) {
    end_as_wrong_use(error.what());
  }
  options.device = devices.completed(options.device);
  return options;
}

}  // namespace forcebound::client
