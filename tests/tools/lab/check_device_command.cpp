#include <sys/mman.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "forcebound/child/in_child.hpp"
#include "forcebound/client/app/known_devices.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/tools/lab/check_device/device_checks.hpp"
#include "tests/tools/lab/check_device/thread_cost.hpp"
#include "tests/tools/lab/check_device/untouched.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/option_checks.hpp"
#include "tests/tools/lab/outputs.hpp"

namespace forcebound::lab {
namespace {

constexpr std::chrono::seconds kCheckLongest{120};

struct CheckDeviceOptions {
  std::string device;
  double force_share = 0.3;
  std::string json;
};

/// What the process that checks tells the one that waits for it, and the other way round.
struct Shared {
  std::array<char, 64> check{};
  std::array<char, 16> call{};
  std::atomic<bool> cancelled{false};
};

/// Memory of two processes.
class SharedPage {
 public:
  SharedPage() : page_(::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (page_ == MAP_FAILED) throw std::runtime_error("no memory to share with a child process");
    shared_ = new (page_) Shared;
  }
  ~SharedPage() { ::munmap(page_, sizeof(Shared)); }
  SharedPage(const SharedPage&) = delete;
  SharedPage& operator=(const SharedPage&) = delete;
  [[nodiscard]] Shared& operator*() const { return *shared_; }

 private:
  void* page_;
  Shared* shared_ = nullptr;
};

std::atomic<bool>* cancelled_by_signal = nullptr;

void cancel_check(int /*signal*/) {
  if (cancelled_by_signal != nullptr) cancelled_by_signal->store(true);
}

class RealPace final : public Pace {
 public:
  Nanoseconds now() override { return clock_.now(); }
  void wait_until(Nanoseconds time) override {
    const ::timespec until{.tv_sec = static_cast<std::time_t>(time.count() / 1'000'000'000),
                           .tv_nsec = static_cast<long>(time.count() % 1'000'000'000)};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) continue;
  }
  CallCost cost_of(const std::function<void()>& call) override { return thread_cost_of(call); }

 private:
  time::SteadyClock clock_;
};

template <std::size_t size>
void put_text(std::array<char, size>& where, const std::string& text) {
  where.fill('\0');
  std::copy_n(text.begin(), std::min(text.size(), size - 1), where.begin());
}

bool is_of_simulated_family(const std::string& device) {
  const auto shipped = device::shipped_device_names();
  // A setting may be a path: force-dimension:library=/opt/libdhd.so.
  return device::names_a_file(device.substr(0, device.find(':'))) ||
         std::ranges::find(shipped, device) != shipped.end();
}

std::unique_ptr<device::HapticDevice> untouched_device(const std::string& name) {
  if (!is_of_simulated_family(name)) return client::known_devices().make({.device = name});
  device::DeviceDescription description = device::load_device(name);
  auto nobody = std::make_unique<Nobody>(description.facts.degrees_of_freedom());
  return std::make_unique<device::SimulatedDevice>(std::move(description), std::move(nobody));
}

DeviceCheck check_unknown_setting(const std::string& device) {
  DeviceCheck check{.name = "unknown setting", .measured = "refused", .accepted = "an error that names it"};
  if (is_of_simulated_family(device)) {
    check.verdict = Verdict::not_checked;
    check.measured = "a simulated device has none";
    return check;
  }
  try {
    (void)untouched_device(device + (device.find(':') == std::string::npos ? ':' : ',') + "no_such_setting=1");
  } catch (const std::exception&) {
    return check;
  }
  check.verdict = Verdict::failed;
  check.measured = "no_such_setting=1 is accepted";
  return check;
}

nlohmann::json json_of_checks(const std::vector<DeviceCheck>& checks) {
  const auto words = [](Verdict verdict) {
    if (verdict == Verdict::passed) return "passed";
    return verdict == Verdict::failed ? "failed" : "not checked";
  };
  nlohmann::json json = nlohmann::json::array();
  for (const DeviceCheck& check : checks) {
    json.push_back({{"check", check.name},
                    {"verdict", words(check.verdict)},
                    {"measured", check.measured},
                    {"accepted", check.accepted}});
  }
  return json;
}

/// In the child process. @returns the checks as JSON
std::string checked(const CheckDeviceOptions& options, Shared& shared) {
  std::signal(SIGINT, SIG_IGN);  // the parent tells
  std::signal(SIGTERM, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
  put_text(shared.check, "open");
  std::vector<DeviceCheck> checks;
  {
    std::unique_ptr<device::HapticDevice> device;
    try {
      device = untouched_device(options.device);
    } catch (const std::invalid_argument& error) {
      return nlohmann::json{{"wrong_use", error.what()}}.dump();
    }
    RealPace pace;
    checks = check_device(*device, pace,
                          {.force_share = options.force_share,
                           .cancelled = [&shared] { return shared.cancelled.load(); },
                           .tell =
                               [&shared](const std::string& check, const char* call) {
                                 put_text(shared.check, check);
                                 put_text(shared.call, call);
                               }});
    put_text(shared.check, "open again");
    put_text(shared.call, "close");
  }
  put_text(shared.call, "open");
  checks.push_back(check_unknown_setting(options.device));
  (void)untouched_device(options.device);
  checks.push_back({.name = "open again", .measured = "opened after close", .accepted = "opens"});
  checks.push_back({.name = "unplugging",
                    .verdict = Verdict::not_checked,
                    .measured = "needs a person who unplugs it",
                    .accepted = ""});
  return json_of_checks(checks).dump();
}

std::string checked_in_child(const CheckDeviceOptions& options) {
  const SharedPage page;
  Shared& shared = *page;
  cancelled_by_signal = &shared.cancelled;
  const auto interrupt = std::signal(SIGINT, cancel_check);
  const auto terminate = std::signal(SIGTERM, cancel_check);
  const auto hang_up = std::signal(SIGHUP, cancel_check);
  const auto restore = [&] {
    std::signal(SIGINT, interrupt);
    std::signal(SIGTERM, terminate);
    std::signal(SIGHUP, hang_up);
    cancelled_by_signal = nullptr;
  };
  try {
    std::string found =
        child::in_child([&] { return checked(options, shared); }, {.time = kCheckLongest, .opens_files = true});
    restore();
    return found;
  } catch (const std::exception& error) {
    restore();
    std::string where = "check '" + std::string(shared.check.data()) + "'";
    if (shared.call[0] != '\0') where += ", last call " + std::string(shared.call.data());
    throw std::runtime_error("device '" + options.device + "', " + where + ": " + error.what());
  }
}

std::string table_of_checks(const nlohmann::json& checks) {
  constexpr std::size_t kName = 20;
  constexpr std::size_t kVerdict = 13;
  std::string text;
  const auto padded = [](std::string words, std::size_t width) {
    words.resize(std::max(words.size() + 1, width), ' ');
    return words;
  };
  for (const auto& check : checks) {
    const auto accepted = check.at("accepted").get<std::string>();
    std::string line = padded(check.at("check"), kName) + padded(check.at("verdict"), kVerdict);
    line += check.at("measured").get<std::string>();
    if (!accepted.empty()) line += " (accepted: " + accepted + ")";
    text += text::wrapped(line, kName + kVerdict) + '\n';
  }
  return text;
}

void run_check_device(const CheckDeviceOptions& options) {
  prepare({.files = {options.json}});
  const nlohmann::json found = nlohmann::json::parse(checked_in_child(options));
  if (found.is_object()) throw std::invalid_argument("--device: " + found.at("wrong_use").get<std::string>());
  std::fputs(table_of_checks(found).c_str(), stdout);
  if (!options.json.empty()) text::write_file(options.json, found.dump(2) + '\n');
  const auto failed = std::ranges::count_if(found, [](const auto& check) { return check.at("verdict") == "failed"; });
  if (failed == 0) return;
  throw std::runtime_error("device '" + options.device + "' failed " + std::to_string(failed) + " of " +
                           std::to_string(found.size()) + " checks");
}

}  // namespace

void add_check_device(CLI::App& app) {
  auto options = std::make_shared<CheckDeviceOptions>();
  CLI::App* command =
      app.add_subcommand("check-device", "Whether a device and its driver do what the interface of drivers says");
  command->add_option("--device", options->device, "device to check, with the settings of its driver")
      ->required()
      ->type_name("NAME[:KEY=VALUE,...]");
  command->add_option("--force-share", options->force_share, "largest force, as a share of the device's largest")
      ->type_name("SHARE")
      ->check(program::number_within(0.01, 1))
      ->capture_default_str();
  add_output(*command, "--json", options->json, "write the checks to this file as well")->type_name("FILE.json");
  command->footer(
      "THE DEVICE MOVES. Let nobody touch it, and leave room for 10 cm of motion along each axis. Each axis is pushed "
      "by a force that grows over 0.3 s, until it has moved 5 mm. Ctrl-C ends the force. With --force-share 1 it is "
      "also asked for more than its largest force, for 30 ms.\n"
      "\n"
      "Checks readings and their times, rest at zero force, signs, axes and units, the hold time, stop and start, "
      "unknown settings, and that no call blocks. All of it runs in a process of its own: where a driver crashes, the "
      "check and the call are told.\n"
      "\n"
      "Ends with 0 if no check failed, with 1 if one did.\n"
      "\n"
      "Examples:\n"
      "  forcebound-lab check-device --device omni\n"
      "  FORCEBOUND_DEVICE_PATH=. forcebound-lab check-device --device pen --json checks.json");
  command->callback([options] { run_check_device(*options); });
}

}  // namespace forcebound::lab
