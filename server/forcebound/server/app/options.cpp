#include "forcebound/server/app/options.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <utility>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::server {
namespace {

constexpr const char* kProgram = "forcebound-server";

constexpr const char* kDescription =
    "Computes the forces of a virtual environment for haptic clients.\n"
    "\n"
    "Each client (forcebound-client) sends its device's position by UDP and receives\n"
    "the force that the scene exerts there. However late it arrives, the client keeps\n"
    "the device passive; the server may be far away. Every client has a scene of its\n"
    "own, unless the scene says that it is shared.\n";

/// CLI::Range accepts "nan" in any range.
CLI::Validator within(double least, double most) {
  const std::string range = text::to_text(least) + " to " + text::to_text(most);
  return {[=](const std::string& value) -> std::string {
            const auto number = text::finite_number(value);
            return number && *number >= least && *number <= most
                       ? ""
                       : "must be a number from " + range + ", got '" + value + "'";
          },
          range};
}

std::string footer() {
  return text::wrapped("Scenes: " + SceneLibrary::shipped().names() + ", or a file of your own (FILE.toml).", 2) +
         "\n"
         "A client may ask for any of them by name; files are opened for --scene only.\n"
         "\n"
         "Examples:\n"
         "  forcebound-server                          the wall, for clients on this machine\n"
         "  forcebound-server --scene sphere --explain what would be simulated, in words\n"
         "  forcebound-server --scene my.toml --explain --calibrate   and what it costs here\n"
         "  forcebound-server --schema                 how to write a scene, with every effect\n"
         "  forcebound-server --listen 0.0.0.0:47800   for clients elsewhere: there is neither\n"
         "                                             encryption nor a password, so use it within\n"
         "                                             a network that you trust\n"
         "\n"
         "Ends on Ctrl-C or SIGTERM: ends its clients' sessions and prints its totals.\n"
         "Exit code: 0 done, 1 failed, 2 wrong use.";
}

void describe(CLI::App& app, ProgramOptions& options, std::string& listen, double& idle_timeout_s,
              double& round_trip_ms) {
  app.description(kDescription);
  app.formatter_fn([](const CLI::App* of, std::string name, CLI::AppFormatMode mode) {
    return text::wrapped_help(CLI::Formatter().make_help(of, std::move(name), mode));
  });
  app.footer(footer());
  app.set_version_flag("--version", std::string(kProgram) + " " + FORCEBOUND_VERSION, "print the version, and end");
  app.set_help_flag("-h,--help", "print this, and end");
  app.add_option("--listen", listen, "address to serve; port 0 takes a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--scene", options.scene, "scene for clients that request none")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  app.add_flag("--explain", options.explain, "print what the scene simulates and what not, and end");
  app.add_flag("--calibrate", options.calibrate, "with --explain: also measure what it costs on this machine, now")
      ->needs("--explain");
  app.add_option("--device-damping", options.device.damping_N_s_per_m,
                 "with --explain: damping of the device for the stability margins")
      ->type_name("N_S_PER_M")
      ->check(within(1e-6, 1e6))
      ->capture_default_str()
      ->needs("--explain");
  app.add_option("--round-trip", round_trip_ms, "with --explain: also print the margins at this round trip")
      ->type_name("MS")
      ->check(within(0, 60000))
      ->needs("--explain");
  app.add_flag("--suggest", options.suggest, "print suggested --device and --operator for a client, and end");
  app.add_flag("--schema", options.schema, "print every key of a scene file, as Markdown, and end");
  app.add_option("--record", options.record, "write every motion answered and every force sent to this MCAP file")
      ->type_name("FILE.mcap");
  app.add_option("--sessions-max", options.server.sessions_max, "most clients at the same time")
      ->type_name("N")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--idle-timeout", idle_timeout_s,
                 "end a client's session after this time without datagrams; mobile networks pause 15 s")
      ->type_name("SECONDS")
      ->check(within(1, 86400))
      ->capture_default_str();
  app.add_flag("--realtime", options.realtime, "ask the system for real-time scheduling and locked memory");
  app.add_flag("-v,--verbose", options.verbose, "print totals every 10 s");
}

}  // namespace

ParsedCommandLine parse_command_line(int argc, const char* const* argv) {
  ParsedCommandLine parsed;
  std::string listen = "127.0.0.1:47800";
  double idle_timeout_s = time::to_seconds(parsed.options.server.idle_timeout);
  double round_trip_ms = 0;
  CLI::App app("", kProgram);
  describe(app, parsed.options, listen, idle_timeout_s, round_trip_ms);
  try {
    app.parse(argc, argv);
    parsed.options.listen = net::parse_endpoint(listen);
    parsed.options.device.round_trip_s = round_trip_ms * 1e-3;
    parsed.options.server.idle_timeout = time::from_seconds(idle_timeout_s);
  } catch (const CLI::Success& success) {
    // Help and version arrive as exceptions; CLI11 knows what to print.
    parsed.exit_code = app.exit(success);
  } catch (const CLI::ParseError& error) {
    std::cerr << kProgram << ": " << error.what() << " (see --help)\n";
    parsed.exit_code = 2;
  } catch (const std::invalid_argument& error) {
    std::cerr << kProgram << ": --listen: " << error.what() << "\n";
    parsed.exit_code = 2;
  }
  return parsed;
}

}  // namespace forcebound::server
