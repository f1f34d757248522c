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
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/figures/draw.hpp"
#include "tests/tools/lab/identify/facts_text.hpp"
#include "tests/tools/lab/identify/live_guide.hpp"
#include "tests/tools/lab/identify/study.hpp"
#include "tests/tools/lab/option_checks.hpp"
#include "tests/tools/lab/outputs.hpp"
#include "tests/tools/lab/progress.hpp"

namespace forcebound::lab {
namespace {

using identify::Findings;
using identify::Guide;
using identify::GuideSettings;
using identify::StudyDevice;
using identify::StudySettings;

struct IdentifyOptions {
  std::string device;
  std::string out;
  std::string figure;
  std::vector<std::string> formats;
  std::string csv;
  std::uint64_t hidden = 0;
  std::uint64_t seed = 1;
  double confidence = 0.99;
  GuideSettings guide{};
};

std::atomic<bool> interrupted{false};
void interrupt(int /*signal*/) { interrupted = true; }

void identify_hidden(const IdentifyOptions& options) {
  StudySettings settings{
      .devices = options.hidden, .seed = options.seed, .confidence = options.confidence, .guide = options.guide};
  std::vector<StudyDevice> devices;
  {
    Progress progress;
    devices = identify::study_devices(settings, [&](std::uint64_t done) {
      progress.tell(static_cast<double>(done) / static_cast<double>(options.hidden),
                    std::to_string(done) + " of " + std::to_string(options.hidden) + " devices");
    });
  }
  std::cout << text::counted(options.hidden, "simulated device", "simulated devices") << " with hidden facts, seed "
            << options.seed << ". " << identify::study_text(devices, text::colour_for(STDOUT_FILENO)) << std::flush;
  if (!options.csv.empty()) text::write_file(options.csv, identify::study_csv(devices));
  if (identify::any_wrong(devices)) throw std::runtime_error("a bound is wrong, see the table");
}

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

void identify_device(const IdentifyOptions& options) {
  const auto device = make_device(options.device);
  const control::DeviceFacts declared = device->facts();
  std::cout << declared.name << (device->is_simulated() ? ", simulated" : "")
            << ": let go of the handle, in the middle of "
            << "its workspace.\nIt will move by itself, up to " << text::rounded(options.guide.radius_m * 100, 2)
            << " cm each way, with at most " << text::rounded(options.guide.force_share * declared.force_N_max)
            << " N. Any button of the device ends it, as does Ctrl-C.\n"
            << std::flush;
  Guide guide(declared, options.guide);
  auto* const before = std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  std::signal(SIGHUP, interrupt);
  std::uint64_t stops = 0;
  {
    Progress progress;
    stops = identify::run_live(guide, *device, declared.period_s, interrupted,
                               [&](double share, const std::string& doing) { progress.tell(share, doing); });
  }
  std::signal(SIGINT, before);
  if (interrupted) throw std::runtime_error("interrupted: the force is zero, and nothing was written");
  if (guide.stopped_by_button()) {
    throw std::runtime_error(guide.trouble() + ": the force is zero, and nothing was written");
  }
  const Findings findings = identify::evaluate(guide, declared, options.confidence);
  std::cout << '\n' << identify::findings_text(findings, declared);
  if (stops > 0) {
    std::cout << "watchdog   stopped the device " << text::counted(stops, "time", "times")
              << ", as no tick had run for its hold time\n";
  }
  if (!options.out.empty()) {
    text::write_file(options.out, identify::facts_text(findings, declared, options.confidence));
    std::cout << "written to " << options.out << '\n';
  }
  if (!options.figure.empty()) {
    draw({.script = "slides", .csv = identify::slides_csv(findings, declared.cartesian)}, options.figure,
         options.formats);
  }
  if (!findings.complete()) throw std::runtime_error("not every fact that a law needs has a bound, see above");
}

void run(const IdentifyOptions& options) {
  if (options.device.empty() == (options.hidden == 0)) {
    throw std::invalid_argument("either --device or --hidden is required");
  }
  prepare({.files = {options.out, options.csv}, .figures = {options.figure}, .formats = options.formats});
  if (options.hidden > 0) {
    identify_hidden(options);
  } else {
    identify_device(options);
  }
}

}  // namespace

void add_identify(CLI::App& app) {
  auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command = app.add_subcommand(
      "identify", "Damping, friction, encoder, latency and hold time of a device, measured by moving it");
  command->add_option("--device", options->device, "device, as for forcebound-client")
      ->check(program::not_empty())
      ->type_name("NAME");
  add_output(*command, "--out", options->out, "write the facts to this file, for --device driver:FILE.so:facts=FILE.toml")
      ->type_name("FILE.toml");
  add_figure(*command, options->figure, options->formats, "draw the slides' force over their speed, with the bounds");
  command->add_option("--force-share", options->guide.force_share, "of the device's largest force")
      ->check(program::number_within(0.01, 1))
      ->type_name("SHARE")
      ->capture_default_str();
  command->add_option("--speed", options->guide.speed_m_per_s_max, "fastest motion of the tip, in m/s")
      ->check(program::number_within(0.01, 5))
      ->type_name("M_PER_S")
      ->capture_default_str();
  command->add_option("--radius", options->guide.radius_m, "how far the tip moves each way, in m")
      ->check(program::number_within(0.002, 1))
      ->type_name("M")
      ->capture_default_str();
  command->add_option("--confidence", options->confidence, "that all bounds hold, together")
      ->check(program::number_within(0.5, 0.9999))
      ->type_name("SHARE")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "of where slides begin, and of the hidden devices")
      ->check(program::whole_within(0))
      ->type_name("SEED")
      ->capture_default_str();
  command->add_option("--hidden", options->hidden, "instead: so many simulated devices, and their truth beside it")
      ->check(program::whole_within(1, 1'000'000))
      ->type_name("N");
  add_output(*command, "--csv", options->csv, "with --hidden: a row for each device")->type_name("FILE.csv");
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
      "force ended. What could not be established is refused with the reason.\n"
      "\n"
      "Ends with 1 where a fact is missing that a law needs; with --hidden where a bound is wrong.\n"
      "\n"
      "Examples:\n"
      "  forcebound-lab identify --device driver:./my-device.so --out facts.toml --figure slides.png\n"
      "  forcebound-lab identify --hidden 500 --seed 1");
  command->callback([options] {
    options->guide.seed = options->seed;
    run(*options);
  });
}

}  // namespace forcebound::lab
