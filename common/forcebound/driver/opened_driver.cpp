#include "forcebound/driver/opened_driver.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/text/printable.hpp"

namespace forcebound::driver {

OpenedDriver::OpenedDriver(std::shared_ptr<const DriverLibrary> library, const DriverRequest& request)
    : library_(std::move(library)) {
  std::vector<forcebound_setting> settings;
  settings.reserve(request.settings.size());
  for (const auto& [key, value] : request.settings) settings.push_back({key.c_str(), value.c_str()});
  std::array<char, FORCEBOUND_TEXT_BYTES> error{};
  const int opened = functions().open(settings.data(), settings.size(), &device_, error.data(), error.size());
  if (opened == FORCEBOUND_OK) return;
  const std::string_view why(error.data(), ::strnlen(error.data(), error.size()));
  throw std::runtime_error("driver '" + text::printable(request.name) +
                           "': " + (why.empty() ? "no device" : text::printable(why)));
}

OpenedDriver::~OpenedDriver() {
  try {
    functions().stop(device_);
    functions().close(device_);
  } catch (...) {  // of a driver in C++; there is nobody left to tell
  }
}

void OpenedDriver::start() {
  if (functions().start(device_) == FORCEBOUND_OK) return;
  (void)note_failure("does not start");
  throw std::runtime_error("driver '" + std::string(functions().name) + "': " + std::string(last_error()));
}

bool OpenedDriver::stop() noexcept {
  try {
    functions().stop(device_);
    return true;
  } catch (...) {
    return false;
  }
}

void OpenedDriver::note_error(std::string_view text) noexcept {
  error_bytes_ = std::min(text.size(), error_.size());
  std::copy_n(text.begin(), error_bytes_, error_.begin());
}

bool OpenedDriver::note_failure(std::string_view otherwise) noexcept {
  if (threw_) return true;
  const char* text = nullptr;
  try {
    if (functions().last_error != nullptr) text = functions().last_error(device_);
  } catch (...) {
    text = nullptr;
  }
  const bool told = text != nullptr && *text != '\0';
  std::string_view words = told ? std::string_view(text, ::strnlen(text, error_.size())) : otherwise;
  while (words.ends_with('\n')) words.remove_suffix(1);
  note_error(words);
  text::make_printable({error_.data(), error_bytes_});
  return told;
}

}  // namespace forcebound::driver
