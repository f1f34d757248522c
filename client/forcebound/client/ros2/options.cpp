#include "forcebound/client/ros2/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <random>
#include <string_view>

#include "forcebound/client/app/device_options.hpp"
#include "forcebound/client/app/known_devices.hpp"
#include "forcebound/client/ros2/topic_names.hpp"
#include "forcebound/device/device_registry.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/program/option_file.hpp"
#include "forcebound/server/app/key_options.hpp"

namespace forcebound::ros2 {
namespace {

constexpr const char* kAbout =
    "Joins a haptic device with ROS 2 by DDS, without an installation of ROS: what a publisher sends on servo_cf is "
    "felt, bounded by a law as a server's forces are, and how the hand moves goes out.\n";

constexpr std::string_view kMore =
    "\n"
    "Topics, by the names of CRTK, geometry_msgs and sensor_msgs: servo_cf (WrenchStamped) comes in; measured_cp "
    "(PoseStamped), measured_cv (TwistStamped), measured_cf (WrenchStamped: what was applied), measured_js "
    "(JointState), joy (Joy) and operating_state (crtk_msgs/OperatingState) go out. Axes: x to the user's right, y "
    "away from the user, z up. The publisher whose wrench comes first is felt alone until it is silent for --drop; "
    "ages count from a wrench's arrival. A wrench that is not finite, or in a frame other than --frame, is refused and "
    "counted.\n"
    "\n"
    "Example, with a publisher on the topic /pen/servo_cf of this machine, such as ROS 2 with ROS_LOCALHOST_ONLY=1:\n"
    "  forcebound-ros2 --device omni --operator trace-sphere --namespace /pen\n"
    "For a forcebound-client on another machine:\n"
    "  forcebound-ros2 --listen 0.0.0.0:47800 --key my.key --clients clients.toml\n"
    "\n";

/// As typed.
struct Typed {
  client::TypedDevice device{};
  client::TypedAges ages{};
  std::string domain{};
  std::string name_space{};
};

void add_topics(CLI::App& app, Options& options, Typed& typed) {
  app.add_option("--namespace", typed.name_space, "of all topics; default: none")->type_name("/NAME");
  app.add_option("--domain", typed.domain, "of DDS, 0 to 232; default: ROS_DOMAIN_ID, else 0")->type_name("N");
  app.add_option("--frame", options.topics.frame, "name of the frame of all messages")
      ->check(program::not_empty())
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--publish-rate", options.publish_Hz, "most messages per second and topic; 0: one for each tick")
      ->check(program::number_within(0))
      ->type_name("HZ")
      ->capture_default_str();
  app.add_flag("--dds-network", options.topics.beyond_this_machine,
               "talk DDS where CYCLONEDDS_URI says, unencrypted: whoever is there may push the hand; default: this "
               "machine only");
}

void add_run(CLI::App& app, Options& options) {
  app.add_option("--duration", options.client.client.duration_s, "length of the run; 0: until interrupted")
      ->check(program::number_within(0))
      ->capture_default_str()
      ->type_name("SECONDS");
  app.add_option("--record", options.client.client.recording, "write every tick and force to this file")
      ->check(program::not_empty())
      ->type_name("FILE.mcap");
  app.add_option("--summary", options.client.summary, "write the summary to this file as well")
      ->check(program::not_empty())
      ->type_name("FILE.json");
  app.add_flag("--quiet", options.client.quiet, "no live line");
}

/// What is of the device here does not go with another's.
void expect_one_hand(const CLI::App& app, const Options& options) {
  if (options.listen.empty()) {
    for (const char* const name : {"--key", "--clients", "--psk", "--insecure"}) {
      if (app.count(name) > 0) throw std::invalid_argument(std::string(name) + " needs --listen");
    }
    return;
  }
  for (const char* const name : {"--device", "--operator", "--rate", "--law", "--law-parameters", "--law-help",
                                 "--memory", "--duration", "--record", "--quiet"}) {
    if (app.count(name) > 0) {
      throw std::invalid_argument(std::string(name) +
                                  " does not go with --listen: device, law and run are the client's");
    }
  }
}

}  // namespace

Options parse_options(int argc, const char* const* argv) {
  Options options;
  options.client.client.program = kProgramAndVersion;
  options.client.client.law = "fba-exact";
  options.client.client.scene = "ros2";
  options.client.client.renders_locally = false;
  options.client.client.seed = std::random_device{}();
  const device::DeviceRegistry devices = client::known_devices();
  Typed typed;
  CLI::App app;
  program::set_up(app, kProgram);
  app.description(kAbout);
  app.footer("Laws (--law):\n" + law_plugin::known_laws().help() + "\n" + devices.help() + std::string(kMore) +
             std::string(program::kExitCodes));
  add_topics(app, options, typed);
  client::add_device_options(app, {.device = options.client.device,
                                   .law = options.client.client.law,
                                   .law_parameters = options.client.law_parameters,
                                   .law_help = options.client.law_help,
                                   .typed = typed.device});
  client::add_late_force_options(app, typed.ages);
  add_run(app, options);
  app.add_option("--listen", options.listen,
                 "no device here: serve one forcebound-client, whose hand the topics are then of; measured_cf is what "
                 "it is sent, before its law")
      ->type_name("HOST:PORT");
  server::add_key_options(app, options.keys);
  program::add_log_option(app);
  program::add_option_file(app);
  program::parse(app, argc, argv);
  options.client.quiet |= program::logs_json();
  expect_one_hand(app, options);
  program::expect_apart({"--summary", options.client.summary}, {{"--record", options.client.client.recording}});
  options.client.client.policy = client::policy_of(typed.ages);
  options.client.law_options.memory = client::memory_of(typed.device);
  options.topics.name_space = program::value_of("--namespace", [&] { return checked_namespace(typed.name_space); });
  options.topics.domain = domain_of(typed.domain, std::getenv("ROS_DOMAIN_ID"));
  if (options.listen.empty()) {
    options.client.device = devices.completed(options.client.device);
    options.client.client.hand = options.client.device.hand;
  }
  return options;
}

}  // namespace forcebound::ros2
