#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "forcebound/client/commands/commands.hpp"
#include "forcebound/client/commands/view/recorded.hpp"
#include "forcebound/client/commands/view/recording_page.hpp"
#include "forcebound/client/commands/view/shipped_appearance.hpp"
#include "forcebound/page/listen_address.hpp"
#include "forcebound/page/page_server.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::client::commands {
namespace {

struct ViewOptions {
  std::string recording;
  std::string page;
  std::string scene;
};

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch what is lock-free");

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = true; });
}

void wait_for_interrupt() {
  while (!interrupted) std::this_thread::sleep_for(std::chrono::milliseconds{50});
}

void run(const ViewOptions& options) {
  const auto at =
      program::value_of("--page", [&] { return page::parse_listen_address(options.page, page::kRecordingPort); });
  Recorded recorded = read_recorded(options.recording);
  if (!recorded.flaw.empty()) std::cerr << text::printable(recorded.flaw) << '\n';
  std::string scene = scene_message_of(recorded, options.scene);
  const page::PageServer::Settings settings = page::page_settings(at, text::program_path());
  if (const std::string why = page::missing_page(text::program_path()); !why.empty())
    std::cerr << text::printable(why) << '\n';
  const std::string words = text::counted(recorded.ticks.size(), "tick") + ", " + text::rounded(recorded.duration_s()) +
                            " s, law " + recorded.info.law + ", scene " +
                            (recorded.scene().empty() ? "not known" : recorded.scene());
  const time::SteadyClock clock;
  RecordingPage shown(std::move(recorded), text::printable(options.recording), std::move(scene), clock);
  const page::PageServer server(settings, shown);
  // Before its address is told: who reads that may end it at once.
  catch_interrupts();
  std::cout << text::printable(options.recording + ": " + words) << "\npage: " << server.address() << std::endl;
  wait_for_interrupt();
}

}  // namespace

void add_view(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* view = app.add_subcommand("view", "Play a recorded run on a live page");
  view->add_option("RECORDING", options->recording, "FILE.mcap that a client's --record wrote")->required();
  view->add_option("--page", options->page,
                   "where the page is served: of this machine alone unless HOST says otherwise; its address is printed")
      ->expected(0, 1)
      ->type_name("PORT|HOST:PORT")
      ->default_str(std::to_string(page::kRecordingPort));
  view->add_option("--scene", options->scene, "scene to draw; default: the one that ships under the recorded name")
      ->type_name("NAME|FILE.toml");
  view->footer(
      "Open the address that it prints in a browser. The page shows the run as a live one is shown: scene, tip, "
      "forces, "
      "charts, P and the ledger, network and events; its slider leads to any time, and it plays up to five times as "
      "fast, or slower. Of a recording that is damaged or was cut off it shows what can be read, and says so. Ctrl-C "
      "ends it.\n"
      "\n"
      "Examples:\n"
      "  forcebound view run.mcap\n"
      "  forcebound view run.mcap --page 8080");
  view->callback([options] { run(*options); });
}

}  // namespace forcebound::client::commands
