#include "forcebound/client/app/run.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/baselines/law_file.hpp"
#include "forcebound/client/app/device_in_words.hpp"
#include "forcebound/client/app/known_devices.hpp"
#include "forcebound/client/app/live_line.hpp"
#include "forcebound/client/app/live_run.hpp"
#include "forcebound/client/app/run_parts.hpp"
#include "forcebound/client/app/screen.hpp"
#include "forcebound/client/runtime/client.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"
#include "forcebound/device/tick_rate.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::client {
namespace {

std::string summary_json(const record::Summary& summary, const std::function<NamedCounts()>& counts) {
  if (!counts) return summary.to_json();
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(summary.to_json());
  for (const auto& [name, count] : counts()) json["counts"][name] = count;
  return json.dump(2) + "\n";
}

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop, const RunAdditions& more) {
  const control::LawRegistry laws = law_plugin::known_laws();
  const device::DeviceRegistry devices = known_devices();
  if (!options.law_help.empty()) {
    const control::DeviceFacts own = devices.facts(options.device.device);
    const control::DeviceFacts facts =
        program::value_of("--rate", [&] { return device::at_tick_rate(own, options.device.rate_Hz); });
    const std::string help = laws.help(options.law_help, facts);
    std::fputs(text::wrapped_help(text::printable_lines(help)).c_str(), stdout);
    return program::kDone;
  }
  if (options.page) return run_with_page(options, laws, devices, stop);
  // What a device is refused for is known from its facts; the rest is about its hand.
  const control::DeviceFacts own = program::value_of("--device", [&] { return devices.facts(options.device.device); });
  (void)program::value_of("--rate", [&] { return device::at_tick_rate(own, options.device.rate_Hz); });
  const auto device = program::value_of("--operator", [&] { return devices.make(options.device); });
  const control::LawOptions chosen = law_options(options, laws);
  auto law = laws.make(options.client.law, device->facts(), chosen);
  Client::Settings settings = options.client;
  const control::LawParameters parameters = laws.parameters(options.client.law, device->facts(), chosen.parameters);
  settings.law_parameters = baselines::describe(parameters);
  if (!settings.recording.empty()) {
    settings.attachments = recorded_files(options.device.device, options.client.law, parameters);
  }
  // Whether the summary can be written is known before the run.
  if (!options.summary.empty()) text::expect_writable(options.summary);
  settings.guarantee = guarantee_with(*device, laws.guarantee(settings.law));

  LiveLine line;
  std::vector<record::TickSink*> sinks = more.sinks;
  sinks.push_back(&line);
  Client client(settings, *device, std::move(law), sinks);
  spdlog::info("{}; law {}, {}, server {}, {}", first_words(*device, options.device.hand), options.client.law,
               rendering_in_words(settings, client), client.server_in_words(), encryption_in_words(settings));
  warn_of_hand(options.device.hand, *device);
  Screen screen(options, line, client.events());
  Nanoseconds last{0};
  bool grant_reported = false;
  const auto housekeeping = [&](Nanoseconds now, Nanoseconds elapsed) {
    if (!grant_reported && client.real_time_grant() != nullptr) {
      grant_reported = true;
      spdlog::info("tick thread: {}", *client.real_time_grant());
    }
    if (const std::string news = client.take_server_news(); !news.empty()) screen.report_news(news);
    if (const std::string problem = client.take_server_problem(); !problem.empty()) {
      screen.report_problem(problem);
    }
    screen.refresh(now, elapsed, client.server_in_words());
    if (const std::string fault = client.take_recording_fault(); !fault.empty()) screen.report_recording_fault(fault);
    if (more.housekeeping) more.housekeeping();
    last = now;
  };
  client.run(stop, housekeeping, [&](std::string_view crash, bool device_stopped) {
    screen.end(last);
    return end_without_summary(*device, crash, device_stopped, !settings.recording.empty());
  });
  screen.end(last);

  std::fputs(client.summary().to_text(text::colour_for(STDOUT_FILENO)).c_str(), stdout);
  const bool written = write_summary(options.summary, summary_json(client.summary(), more.counts));
  const std::string why_none = client.why_no_session();
  if (!why_none.empty()) spdlog::error("gave up: {}", why_none);
  return exit_code_of(client, written);
}

}  // namespace forcebound::client
