#include "forcebound/client/app/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <random>
#include <string_view>
#include <vector>

#include "forcebound/client/app/device_options.hpp"
#include "forcebound/client/app/identity_options.hpp"
#include "forcebound/client/app/known_devices.hpp"
#include "forcebound/client/page/known_scenes.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/tick_rate.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/program/option_file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::client {
namespace {

constexpr const char* kAbout =
    "The device side of Forcebound: reads a haptic device 1000 times a second, or --rate, sends its motion to a "
    "server, and applies the "
    "forces that come back, bounded so that the device never returns more energy than its damping takes, however late "
    "they are.\n";

constexpr std::string_view kMore =
    "\n"
    "A force is applied as it is while the motion it answers is younger than --hold, then fades, and is zero from "
    "--drop on. On a terminal a line shows the run as it goes; at the end, also after Ctrl-C, a summary is printed. "
    "NO_COLOR=1 leaves out colours.\n"
    "\n"
    "Example, with forcebound-server --scene sphere running on this machine:\n"
    "  forcebound-client --server 127.0.0.1:47800 --device omni \\\n"
    "    --operator trace-sphere --law fba-more --duration 20\n"
    "With a server on another machine, whose public key its owner has told:\n"
    "  forcebound-client --server haptics.example.org:47800 --key my.key --server-key server.pub\n"
    "With a server of a fleet:\n"
    "  forcebound-client --allocate https://allocator.example.org \\\n"
    "    --allocate-ca ca.pem --allocate-certificate my.pem \\\n"
    "    --allocate-key my-key.pem --key my.key --server-key fleet.pub\n"
    "\n";

/// Folder of the user's files that programs can make again; empty if the environment names none.
std::string default_scene_cache() {
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache != 0) return std::string(cache) + "/forcebound";
  const char* const home = std::getenv("HOME");
  return home != nullptr && *home != 0 ? std::string(home) + "/.cache/forcebound" : "";
}

/// As typed: not yet in the units and types of the options.
struct Typed {
  TypedDevice device{};
  TypedAges ages{};
  std::string rendering = "local";
  std::string send_rate = "1000";
  std::string page{};
};

/// How forces come to be: where, how often, how fast and until when.
void add_rendering(CLI::App& app, Options& options, Typed& typed) {
  app.add_option("--rendering", typed.rendering,
                 "local: what does not move in the scene is handed over and runs at the client, unless the law has a "
                 "server-side law; remote: all forces are the server's")
      ->check(program::one_of("rendering", {"local", "remote"}))
      ->type_name("local|remote")
      ->capture_default_str();
  app.add_option("--scene-cache", options.client.scene_cache,
                 "folder for scenes that were handed over, or none; default: forcebound in the user's cache folder")
      ->check(program::not_empty())
      ->type_name("FOLDER|none");
  app.add_option(
         "--force-slew", options.client.force_slew_N_per_s,
         "largest change of the requested force per second, against servers that jerk; a slow one also prolongs "
         "how a force fades; 0: no limit")
      ->check(program::number_within(0))
      ->type_name("N/s")
      ->capture_default_str();
  app.add_option("--torque-slew", options.client.torque_slew_N_m_per_s,
                 "likewise of the requested torque, which a device of six axes shows; 0: no limit")
      ->check(program::number_within(0))
      ->type_name("N_m/s")
      ->capture_default_str();
  app.add_option("--send-rate", typed.send_rate,
                 "motions per second, 10 at least; a tick sends one at most. auto: as few as what runs at the client "
                 "allows")
      ->type_name("HZ|auto")
      ->capture_default_str();
  add_late_force_options(app, typed.ages);
}

/// @returns the seed's option, to know whether it was given
const CLI::Option* describe(CLI::App& app, Options& options, Typed& typed, const control::LawRegistry& laws,
                            const device::DeviceRegistry& devices) {
  program::set_up(app, kProgram);
  app.description(kAbout);
  app.footer("Laws (--law):\n" + laws.help() + "\n" + devices.help() + std::string(kMore) +
             std::string(program::kExitCodes));
  app.add_option("--server", options.client.server,
                 "the server, or a relay in front of it (required without --allocate)")
      ->type_name("HOST:PORT");
  add_allocation_options(app, options.allocation);
  add_identity_options(app, options.client.identity);
  app.add_flag("--insecure", options.client.insecure,
               "do not encrypt, although the server is on another machine: anybody on the way can read, change and "
               "forge");
  app.add_option("--scene", options.client.scene, "scene to request; default: the server's")->type_name("NAME");
  add_device_options(app, {.device = options.device,
                           .law = options.client.law,
                           .law_parameters = options.law_parameters,
                           .law_help = options.law_help,
                           .typed = typed.device});
  app.add_option("--duration", options.client.duration_s, "length of the run; 0: until interrupted")
      ->check(program::number_within(0))
      ->capture_default_str()
      ->type_name("SECONDS");
  const CLI::Option* const seed =
      app.add_option("--seed", options.client.seed, "seed of the handshake's nonces; default: random")
          ->check(program::whole_within(0))
          ->type_name("N");
  app.add_option("--record", options.client.recording,
                 "write every tick and force to this file, and what Foxglove's 3D panel shows of them")
      ->check(program::not_empty())
      ->type_name("FILE.mcap");
  app.add_option("--summary", options.summary, "write the summary to this file as well")
      ->check(program::not_empty())
      ->type_name("FILE.json");
  add_rendering(app, options, typed);
  app.add_option("--page", typed.page,
                 "serve a live page that shows the run and changes it, with the mouse as the simulated hand; its "
                 "address is printed. Of this machine alone unless HOST says otherwise; default port " +
                     std::to_string(page::kClientPort))
      ->expected(0, 1)
      ->type_name("[PORT|HOST:PORT]");
  app.add_option("--relay-control", options.relay_control,
                 "with --page: the --control address of the forcebound-relay in between, for other networks")
      ->needs("--page")
      ->type_name("HOST:PORT");
  app.add_flag(
      "--once", options.client.once,
      "end if the server does not answer for 5 s, or has lost the session and refuses another, instead of retrying");
  app.add_flag("--quiet", options.quiet, "no live line");
  program::add_log_option(app);
  program::add_option_file(app);
  return seed;
}

void expect_files_apart(const Options& options) {
  const bool has_device_file = device::names_a_file(options.device.device);
  const std::vector<program::FileOption> inputs{{"--device", has_device_file ? options.device.device : ""},
                                                {"--operator", device::recorded_hand(options.device.hand)},
                                                {"--law-parameters", options.law_parameters},
                                                {"--key", options.client.identity.key},
                                                {"--known-servers", options.client.identity.known_servers},
                                                {"--psk", options.client.identity.shared_key}};
  program::expect_apart({"--record", options.client.recording}, inputs);
  program::expect_apart({"--summary", options.summary}, inputs);
  program::expect_apart({"--summary", options.summary}, {{"--record", options.client.recording}});
}

/// @throws std::invalid_argument if forces are to be computed here, and the law needs all of them from the server
void expect_rendering_of_law(const control::LawRegistry& laws, const std::string& law) {
  if (!laws.find(law).make_server_side) return;
  std::vector<std::string> such = laws.names();
  std::erase_if(such, [&](const std::string& name) { return !laws.find(name).make_server_side; });
  throw std::invalid_argument("--rendering local: all forces go through the server-side law of '" + law +
                              "'; accepted are --rendering remote, or a law other than " + text::join(such));
}

/// With a page and no other operator the hand follows the pointer, on a device that suits the scene.
void complete_for_page(Options& options, const device::DeviceRegistry& devices) {
  if (!options.device.hand.empty()) return;
  if (options.device.device.empty()) {
    const KnownScene* const scene = find_known_scene(options.client.scene);
    options.device.device = scene == nullptr ? "omni" : device_for(*scene);
  }
  // Only a simulated device has a hand.
  if (!devices.completed(options.device).hand.empty()) options.device.hand = "pointer";
}

}  // namespace

Options parse_options(int argc, const char* const* argv) {
  Options options;
  options.client.program = "forcebound-client " FORCEBOUND_VERSION;
  options.client.law = "fba-exact";
  options.client.scene_cache = default_scene_cache();
  Typed typed;
  const control::LawRegistry laws = law_plugin::known_laws();
  const device::DeviceRegistry devices = known_devices();
  CLI::App app;
  const CLI::Option* const seed = describe(app, options, typed, laws, devices);
  program::parse(app, argc, argv);
  // The live line would be between the lines of JSON.
  options.quiet |= program::logs_json();
  expect_files_apart(options);
  if (options.client.insecure && options.client.identity.any()) {
    throw std::invalid_argument("--insecure excludes --key, --server-key, --known-servers, --trust-new and --psk");
  }

  options.client.policy = policy_of(typed.ages);
  options.client.renders_locally = typed.rendering == "local";
  if (app.count("--rendering") > 0 && options.client.renders_locally) {
    expect_rendering_of_law(law_plugin::known_laws(), options.client.law);
  }
  if (options.client.scene_cache == "none") options.client.scene_cache.clear();
  options.client.send_rate = program::value_of("--send-rate", [&] { return parse_send_rate(typed.send_rate); });
  options.law_options.memory = memory_of(typed.device);
  if (options.law_help.empty()) {
    expect_complete(options.allocation);
    if (!options.client.server.empty()) {
      program::value_of("--server", [&] { return net::parse_peer(options.client.server); });
    } else if (options.allocation.url.empty()) {
      throw std::invalid_argument("--server is required");
    }
  }
  // Not the nonce of the previous run: a server that still has that session would take this run for it.
  if (seed->count() == 0) options.client.seed = std::random_device{}();
  if (app.count("--page") > 0) {
    options.page =
        program::value_of("--page", [&] { return page::parse_listen_address(typed.page, page::kClientPort); });
    complete_for_page(options, devices);
  }
  options.device = devices.completed(options.device);
  options.client.hand = options.device.hand;
  return options;
}

}  // namespace forcebound::client
