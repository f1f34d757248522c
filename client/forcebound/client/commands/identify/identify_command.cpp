#include <unistd.h>
#include <CLI/CLI.hpp>

#include <atomic>
#include <csignal>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/client/app/known_devices.hpp"
#include "forcebound/client/commands/commands.hpp"
#include "forcebound/client/commands/identify/facts_text.hpp"
#include "forcebound/client/commands/identify/guide_options.hpp"
#include "forcebound/client/commands/identify/live_guide.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/figure_scripts.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::client::commands {
namespace {

using identify::Findings;
using identify::Guide;

struct IdentifyOptions {
  std::string device;
  std::string out;
  std::string figure;
  std::vector<std::string> formats;
  identify::GuideOptions guided{};
  identify::KnownMass known{.share = 0.01};
};

std::atomic<bool> interrupted{false};
void interrupt(int /*signal*/) { interrupted = true; }

/// A simulated device is held by a simulated hand, which here must let go.
device::DeviceRequest request_of(const std::string& device) {
  return {.device = device, .hand = "wave:mass_kg=0,stiffness_N_per_m=0,damping_N_s_per_m=0"};
}

std::unique_ptr<device::HapticDevice> make_device(const std::string& name) {
  const device::DeviceRegistry devices = client::known_devices();
  try {
    return devices.make(request_of(name));
  } catch (const std::invalid_argument&) {
    // A device of a driver takes no hand.
    return devices.make(devices.completed({.device = name}));
  }
}

/// One known mass is that of each joint.
identify::KnownMass known_mass(identify::KnownMass known, const control::DeviceFacts& declared) {
  const auto joints = static_cast<std::size_t>(declared.joints());
  if (known.of_joints.size() == 1) known.of_joints.resize(joints, known.of_joints.front());
  if (!known.of_joints.empty() && known.of_joints.size() != joints) {
    throw std::invalid_argument("--known-mass must be one number, or one for each of the " +
                                text::counted(joints, "joint", "joints") + " of '" + declared.name + "', got " +
                                std::to_string(known.of_joints.size()));
  }
  return known;
}

void identify_device(const IdentifyOptions& options) {
  const auto device = make_device(options.device);
  const control::DeviceFacts declared = device->facts();
  const identify::KnownMass known = known_mass(options.known, declared);
  std::cout << declared.name << (device->is_simulated() ? ", simulated" : "")
            << ": let go of the handle, in the middle of "
            << "its workspace.\nIt will move by itself, up to " << text::rounded(options.guided.guide.radius_m * 100, 2)
            << " cm each way, with at most " << text::rounded(options.guided.guide.force_share * declared.force_N_max)
            << " N. Any button of the device ends it, as does Ctrl-C.\n"
            << std::flush;
  Guide guide(declared, options.guided.guide);
  auto* const before = std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  std::signal(SIGHUP, interrupt);
  std::uint64_t stops = 0;
  {
    program::Progress progress;
    stops = identify::run_live(guide, *device, declared.period_s, interrupted,
                               [&](double share, const std::string& doing) { progress.report(share, doing); });
  }
  std::signal(SIGINT, before);
  if (interrupted) throw std::runtime_error("interrupted: the force is zero, and nothing was written");
  if (guide.stopped_by_button()) {
    throw std::runtime_error(guide.trouble() + ": the force is zero, and nothing was written");
  }
  const Findings findings = identify::evaluate(guide, declared, options.guided.confidence, known);
  std::cout << '\n' << identify::findings_text(findings, declared);
  if (stops > 0) {
    std::cout << "watchdog   stopped the device " << text::counted(stops, "time", "times")
              << ", as no tick had run for its hold time\n";
  }
  if (!options.out.empty()) {
    text::write_file(options.out, identify::facts_text(findings, declared, options.guided.confidence));
    std::cout << "written to " << options.out << '\n';
  }
  if (!options.figure.empty()) {
    results::draw({.script = text::text_of(results::figure_scripts(), "slides"),
                   .csv = identify::slides_csv(findings, declared.cartesian)},
                  options.figure, options.formats);
  }
  if (!findings.complete()) throw std::runtime_error("not every fact that a law needs has a bound, see above");
}

void run(const IdentifyOptions& options) {
  results::prepare({.files = {options.out}, .figures = {options.figure}, .formats = options.formats});
  identify_device(options);
}

}  // namespace

void add_identify(CLI::App& app) {
  auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command = app.add_subcommand("identify", "Measure a device: damping, friction, times");
  command->add_option("--device", options->device, "device, as for forcebound-client")
      ->required()
      ->check(program::not_empty())
      ->type_name("NAME");
  program::add_output(*command, "--out", options->out,
                      "write the facts to this file, for --device DRIVER:facts=FILE.toml")
      ->type_name("FILE.toml");
  program::add_figure(*command, options->figure, options->formats,
                      "draw the slides' force over their speed, with the bounds");
  identify::add_guide_options(*command, options->guided, "of where slides begin");
  auto* const known =
      command
          ->add_option("--known-mass", options->known.of_joints,
                       "moving mass of each axis, or inertia of each joint in kg m^2: its motor's gain is told then")
          ->delimiter(',')
          ->check(program::number_within(1e-7, 100))
          ->type_name("KG");
  command->add_option("--mass-share", options->known.share, "the known mass is within this share of the truth")
      ->needs(known)
      ->check(program::number_within(0, 0.5))
      ->type_name("SHARE")
      ->capture_default_str();
  command->footer(
      "Put the handle into the middle of its workspace and let go of it. One joint after another is pushed by a force "
      "that grows until it moves, then to and fro by constant forces that end in mid-motion; the others are held. "
      "Forces grow in a ramp, to the largest allowed in 30 ms; only their end is a step, from which latency and hold "
      "time "
      "are read. A button of the device, Ctrl-C, a tip faster or farther away than it should be and a reading that "
      "fails "
      "for a second end all of it with zero force.\n"
      "\n"
      "Damping and friction come from the energy that each of these slides took, latency and hold time from where the "
      "force ended. What could not be established is refused with the reason. Motors that differ show in no motion but "
      "against a known mass.\n"
      "\n"
      "Ends with 1 where a fact is missing that a law needs.\n"
      "\n"
      "Examples:\n"
      "  forcebound identify --device driver:./my-device.so --out facts.toml --figure slides.png");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::client::commands
