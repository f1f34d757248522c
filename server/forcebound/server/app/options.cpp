#include "forcebound/server/app/options.hpp"

#include <CLI/CLI.hpp>

#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "forcebound/http/client.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/exit_codes.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/program/option_file.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/runtime/memory_in_use.hpp"

namespace forcebound::server {
namespace {

constexpr std::size_t kMebibyte = std::size_t{1} << 20U;

constexpr const char* kDescription =
    "Computes the forces of a virtual environment for haptic clients.\n"
    "\n"
    "Each client (forcebound-client) sends its device's position by UDP and receives the force that the scene exerts "
    "there. However late it arrives, the client keeps the device passive; the server may be far away. Every client has "
    "a scene of its own, unless the scene says that it is shared.\n";

std::string fleet_help() {
  if (!http::refusal().empty()) return "It serves in no fleet of Agones: " + std::string(http::refusal()) + ".\n";
  return "In a fleet of Agones, which sets AGONES_SDK_HTTP_PORT, it tells the fleet when it is ready, in use, healthy "
         "and at its end.\n";
}

std::string footer() {
  return "Scenes: " + SceneLibrary::shipped().names() +
         ", or a file of your own (FILE.toml).\n"
         "A client may ask for any of them by name; files are opened for --scene only.\n"
         "\n" +
         robot_help() +
         "\n"
         "Examples:\n"
         "  forcebound-server\n"
         "      the wall, for clients on this machine\n"
         "  forcebound-server --scene sphere --explain\n"
         "      what would be simulated, in words\n"
         "  forcebound-server --scene my.toml --explain --calibrate\n"
         "      and what it costs here\n"
         "  forcebound-server --schema\n"
         "      how to write a scene, with every effect\n"
         "  forcebound-server --listen 0.0.0.0:47800 --key server.key --clients clients.toml\n"
         "      for clients elsewhere, which clients.toml names with their public keys; forcebound keygen "
         "server.key makes the key\n"
         "  forcebound-server --listen 0.0.0.0:47800 --psk shared.key\n"
         "      for everybody elsewhere who has the same shared.key\n"
         "\n"
         "Ends on Ctrl-C or SIGTERM: ends its clients' sessions and prints its totals. SIGHUP reads the file of "
         "--clients again: who is not named any more is heard no more, and what else changed holds for who comes next. "
         "As a service of systemd it "
         "takes a socket from there, and tells it when it is ready, that it runs, and when it ends. " +
         fleet_help() + program::exit_codes_without({program::kNotPassive, program::kNeverConnected});
}

/// As a user writes it.
struct Typed {
  std::string listen = "127.0.0.1:47800";
  std::string page{};
  double idle_timeout_s = time::to_seconds(ServerOptions{}.idle_timeout);
  double round_trip_ms = 0;
  double drain_s = 0;
  std::string after_use = "ready";
  std::uint64_t session_MiB = MemoryLimits{}.session_most / kMebibyte;
  std::uint64_t all_MiB = memory_of_machine() / 2 / kMebibyte;
};

/// What is simulated, or only told of, and what is written down.
void add_scene(CLI::App& app, ProgramOptions& options, Typed& typed) {
  CLI::Option* const scene = app.add_option("--scene", options.scene, "scene for clients that request none")
                                 ->type_name("NAME|FILE.toml")
                                 ->capture_default_str();
  add_robot_options(app, options.start_robot, options.server.laws);
  app.get_option("--follower")->excludes(scene);
  app.add_option("--scene-files", options.scene_files,
                 "folder in which files that the scene names may lie, besides the scene's own; may be repeated")
      ->type_name("FOLDER")
      ->allow_extra_args(false)
      ->check(program::not_empty());
  CLI::Option* const explain =
      app.add_flag("--explain", options.explain, "print what the scene simulates and what not, and end");
  app.add_flag("--calibrate", options.calibrate, "with --explain: also measure what it costs on this machine, now")
      ->needs("--explain");
  app.add_option("--device-damping", options.device.damping_N_s_per_m,
                 "with --explain: damping of the device for the stability margins")
      ->type_name("N_S_PER_M")
      ->check(program::number_within(1e-6, 1e6))
      ->capture_default_str()
      ->needs("--explain");
  app.add_option("--round-trip", typed.round_trip_ms, "with --explain: also print the margins at this round trip")
      ->type_name("MS")
      ->check(program::number_within(0, 60000))
      ->needs("--explain");
  CLI::Option* const suggest =
      app.add_flag("--suggest", options.suggest, "print suggested --device and --operator for a client, and end")
          ->excludes(explain);
  CLI::Option* const schema =
      app.add_flag("--schema", options.schema, "print every key of a scene file, as Markdown, and end")
          ->excludes(explain)
          ->excludes(suggest);
  app.add_option(
         "--record", options.record,
         "write every motion answered and every force sent to this file, and what Foxglove's 3D panel shows of them")
      ->check(program::not_empty())
      ->excludes(explain)
      ->excludes(suggest)
      ->excludes(schema)
      ->type_name("FILE.mcap");
}

/// Who may use how much.
void add_limits(CLI::App& app, ProgramOptions& options, Typed& typed) {
  app.add_option("--workers", options.workers,
                 "threads that serve at the same address, each with its own sessions; 0: one for each processor that "
                 "this process may use, by its affinity and by its control group's quota. A robot (--follower) and a "
                 "socket from the service manager have one")
      ->type_name("N")
      ->check(program::whole_within(0, static_cast<int>(WorkerPlace::kWorkersMost)))
      ->capture_default_str();
  app.add_option("--sessions-max", options.server.sessions_max, "most clients at the same time")
      ->type_name("N")
      ->check(program::whole_within(1, 10000))
      ->capture_default_str();
  app.add_option("--scenes", options.server.scenes,
                 "scenes that clients may request, besides --scene; all if not given")
      ->type_name("NAME,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(program::not_empty());
  app.add_option("--sessions-per-address", options.server.sessions_per_address,
                 "most clients at the same time from one IP address; no such limit if not given")
      ->type_name("N")
      ->check(program::whole_within(1, 10000));
  app.add_option("--session-compute", options.server.session_compute_max,
                 "share of a processor that the answers of one client may take while there are others")
      ->type_name("SHARE")
      ->check(program::number_within(0.001, 1))
      ->capture_default_str();
  app.add_option("--load-max", options.server.load_max, "share of a processor above which no more clients are let in")
      ->type_name("SHARE")
      ->check(program::number_within(0.01, 1))
      ->capture_default_str();
  constexpr int kMebibytesMost = 1 << 24;
  app.add_option("--session-memory", typed.session_MiB, "memory that one client's scene may take")
      ->type_name("MIB")
      ->check(program::whole_within(1, kMebibytesMost))
      ->capture_default_str();
  app.add_option("--memory-max", typed.all_MiB,
                 "memory of the server above which no more clients are let in; if not given, half of the machine's")
      ->type_name("MIB")
      ->check(program::whole_within(1, kMebibytesMost));
  app.add_option("--idle-timeout", typed.idle_timeout_s,
                 "end a client's session after this time without datagrams; mobile networks pause 15 s")
      ->type_name("SECONDS")
      ->check(program::number_within(1, 86400))
      ->capture_default_str();
  app.add_option("--drain", typed.drain_s,
                 "after SIGTERM, let no more clients in and wait up to this time for those that are there to leave; a "
                 "second SIGTERM ends at once")
      ->type_name("SECONDS")
      ->check(program::number_within(0, 86400))
      ->capture_default_str();
  app.add_option("--fleet-after-use", typed.after_use,
                 "as a server of an Agones fleet, 5 s after the last client has left: ready for the next, or shutdown")
      ->check(program::one_of("end of use", {"ready", "shutdown"}))
      ->type_name("ready|shutdown")
      ->capture_default_str();
}

void describe(CLI::App& app, ProgramOptions& options, Typed& typed) {
  program::set_up(app, kProgram);
  app.description(kDescription);
  app.footer(footer());
  app.add_option("--listen", typed.listen, "address to serve; port 0 takes a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--page", typed.page,
                 "serve a live page of the sessions, their figures also as /metrics; its address is printed. Of this "
                 "machine alone unless HOST says otherwise; default port " +
                     std::to_string(page::kServerPort))
      ->expected(0, 1)
      ->type_name("[PORT|HOST:PORT]");
  add_key_options(app, options.keys);
  add_scene(app, options, typed);
  add_limits(app, options, typed);
  app.add_flag("--realtime", options.realtime, "ask the system for real-time scheduling and locked memory");
  app.add_flag("-v,--verbose", options.verbose, "log totals every 10 s");
  program::add_log_option(app);
  program::add_option_file(app);
}

/// @throws std::invalid_argument for an option about a scene where there is a robot instead
void expect_scene(const ProgramOptions& options) {
  if (!options.start_robot || !(options.explain || options.suggest)) return;
  throw std::invalid_argument(options.explain ? "--explain tells of a scene's effects, and --follower has none: --help "
                                                "tells what robots and tasks are"
                                              : "--suggest tries a hand on a scene's shapes, and --follower has none: "
                                                "any device with three axes can lead the robot");
}

}  // namespace

ProgramOptions parse_command_line(int argc, const char* const* argv) {
  ProgramOptions options;
  Typed typed;
  CLI::App app;
  describe(app, options, typed);
  program::parse(app, argc, argv);
  if (is_scene_file(options.scene)) {
    program::expect_apart({"--record", options.record}, {{"--scene", options.scene}});
  }
  expect_scene(options);
  expect_bounds(options.keys);
  program::expect_apart(
      {"--record", options.record},
      {{"--key", options.keys.key}, {"--clients", options.keys.clients}, {"--psk", options.keys.psk}});
  options.listen = program::value_of("--listen", [&] { return net::parse_endpoint(typed.listen); });
  if (app.count("--page") > 0) {
    options.page =
        program::value_of("--page", [&] { return page::parse_listen_address(typed.page, page::kServerPort); });
  }
  options.device.round_trip_s = typed.round_trip_ms * 1e-3;
  options.server.memory = {
      .session_most = typed.session_MiB * kMebibyte, .all_most = typed.all_MiB * kMebibyte, .in_use = memory_in_use};
  options.server.idle_timeout = time::from_seconds(typed.idle_timeout_s);
  options.after_use = typed.after_use == "ready" ? AfterUse::ready : AfterUse::shut_down;
  options.drain = time::from_seconds(typed.drain_s);
  return options;
}

}  // namespace forcebound::server
