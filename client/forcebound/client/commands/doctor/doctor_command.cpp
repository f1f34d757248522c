#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/client/app/identity_options.hpp"
#include "forcebound/client/commands/commands.hpp"
#include "forcebound/client/commands/doctor/doctor_report.hpp"
#include "forcebound/client/commands/doctor/doctor_verdict.hpp"
#include "forcebound/client/commands/doctor/examination.hpp"
#include "forcebound/net/endpoint.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"

namespace forcebound::client::commands {
namespace {

// The client's own counts of losses look back over one minute.
constexpr double kDoctorSeconds_max = 60;
constexpr double kDoctorSeconds_min = 0.1;

struct DoctorCommandOptions {
  ExaminationSettings settings;
  std::string json;
};

void run_doctor(const DoctorCommandOptions& options) {
  results::prepare({.files = {options.json}});
  const DoctorFindings findings = [&] {
    program::Progress progress;
    return examine(options.settings,
                   [&progress](double share, const std::string& words) { progress.report(share, words); });
  }();
  const DoctorVerdict verdict = doctor_verdict(findings);
  std::fputs(doctor_text(findings, verdict).c_str(), stdout);
  if (!options.json.empty()) text::write_file(options.json, doctor_json(findings, verdict).dump(2) + '\n');
}

}  // namespace

void add_doctor(CLI::App& app) {
  auto options = std::make_shared<DoctorCommandOptions>();
  CLI::App* command = app.add_subcommand("doctor", "What a network and this machine will feel like");
  command->add_option("--server", options->settings.server.name, "server to examine the way to")
      ->required()
      ->check(program::accepted_by([](const std::string& peer) { (void)net::parse_peer(peer); }))
      ->type_name("HOST:PORT");
  client::add_identity_options(*command, options->settings.server.identity);
  command->add_option("--seconds", options->settings.seconds, "length of the measurement")
      ->type_name("SECONDS")
      ->check(program::number_within(kDoctorSeconds_min, kDoctorSeconds_max))
      ->capture_default_str();
  command->add_option("--scene", options->settings.scene, "scene to request; default: the server's")->type_name("NAME");
  program::add_output(*command, "--json", options->json, "write all that was found to this file as well")
      ->type_name("FILE.json");
  command->footer(
      "Measures the handshake, round trips, losses and reordering of each direction, the size of packets that arrive "
      "whole, the offset and drift of the clocks, and the jitter of a tick beside a thread that only sleeps. Run it as "
      "the user that will run the client, on the same machine. It takes a place in the scene, with a hand that rests "
      "at the origin; name another scene where several people share one.\n"
      "\n"
      "Ends with 0 where the server answers, whatever the verdict says, and with 1 where it does not.\n"
      "\n"
      "Examples:\n"
      "  forcebound doctor --server 127.0.0.1:47800\n"
      "  forcebound doctor --server there.example:47800 --psk shared.key\n"
      "  forcebound doctor --server there.example:47800 --scene dome --seconds 20 --json found.json");
  command->callback([options] { run_doctor(*options); });
}

}  // namespace forcebound::client::commands
