#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "forcebound/client/app/options.hpp"
#include "forcebound/client/runtime/client.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/record/summary.hpp"

namespace forcebound::client {

/// False, and logged, if not all of it could be written. @param file empty: it is not wanted
bool write_summary(const std::string& file, const std::string& json);

/// @throws std::exception if the file with the law's parameters is refused
[[nodiscard]] control::LawOptions law_options(const Options& options, const control::LawRegistry& laws);

/// "local rendering"; and why it is remote where that was not chosen.
[[nodiscard]] std::string rendering_in_words(const Client::Settings& settings, const Client& client);

[[nodiscard]] std::string_view encryption_in_words(const Client::Settings& settings);

/// What the results of a run make of a program's exit code.
[[nodiscard]] int exit_code_of(const Client& client, bool summary_written);

/// Says why a run ends without a summary, as Client::Lost is told. @returns the program's exit code
[[nodiscard]] int end_without_summary(const device::HapticDevice& device, std::string_view crash, bool device_stopped,
                                      bool has_recording);

/// What a recording has within: the device's file, if it has one, and the law with its parameters.
[[nodiscard]] std::vector<record::RecordedFile> recorded_files(const std::string& device, const std::string& law,
                                                               const control::LawParameters& parameters);

}  // namespace forcebound::client
