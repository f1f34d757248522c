#include "forcebound/client/app/run_parts.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <stdexcept>

#include "forcebound/baselines/law_file.hpp"
#include "forcebound/client/app/device_in_words.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/shipped_devices.hpp"
#include "forcebound/driver/crash.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::client {

bool write_summary(const std::string& file, const std::string& json) {
  if (file.empty()) return true;
  try {
    text::write_file(file, json);
    return true;
  } catch (const std::runtime_error& error) {
    spdlog::error("{}", error.what());
    return false;
  }
}

control::LawOptions law_options(const Options& options, const control::LawRegistry& laws) {
  control::LawOptions chosen = options.law_options;
  if (!options.law_parameters.empty()) {
    chosen.parameters = baselines::load_law_parameters(options.law_parameters, options.client.law, laws);
  }
  return chosen;
}

std::string rendering_in_words(const Client::Settings& settings, const Client& client) {
  const std::string& asked = client.summary().info().rendering;
  const bool by_law = settings.renders_locally && asked == "remote";
  return asked + " rendering" + (by_law ? ", as all forces go through its server-side law" : "");
}

std::string_view encryption_in_words(const Client::Settings& settings) {
  if (settings.identity.any()) return "encrypted";
  return settings.insecure ? "NOT ENCRYPTED (--insecure)" : "not encrypted: on this machine";
}

int exit_code_of(const Client& client, bool summary_written) {
  if (client.summary().not_passive()) return program::kNotPassive;
  const bool connected = client.summary().connected();
  if (connected && !client.why_no_session().empty()) return program::kFailed;
  if (!summary_written || !client.recording_complete()) return program::kOutputLost;
  return connected ? program::kDone : program::kNeverConnected;
}

int end_without_summary(const device::HapticDevice& device, std::string_view crash, bool device_stopped,
                        bool has_recording) {
  static_assert(program::kDriverCrashed == driver::kCrashExit);
  spdlog::error("{}", lost_words(device, crash, device_stopped, has_recording));
  spdlog::shutdown();
  return crash.empty() ? program::kFailed : program::kDriverCrashed;
}

std::vector<record::RecordedFile> recorded_files(const std::string& device, const std::string& law,
                                                 const control::LawParameters& parameters) {
  constexpr const char* kToml = "application/toml";
  std::vector<record::RecordedFile> files;
  std::string text;
  if (device::names_a_file(device) && std::filesystem::is_regular_file(device)) {
    text = text::read_file(device);
  } else {
    for (const text::EmbeddedText& shipped : device::shipped_devices()) {
      if (shipped.name == device) text = shipped.text;
    }
  }
  if (!text.empty()) files.push_back({"device.toml", kToml, text});
  std::string table = "[" + law + "]\n";
  for (const auto& [key, value] : parameters) table += key + " = " + text::to_text(value) + '\n';
  files.push_back({"law.toml", kToml, table});
  return files;
}

}  // namespace forcebound::client
