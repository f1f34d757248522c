#include "forcebound/driver/opened_driver.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/text/printable.hpp"

namespace forcebound::driver {

OpenedDriver::OpenedDriver(std::shared_ptr<const DriverLibrary> library, const DriverRequest& request)
    : library_(std::move(library)) {
  std::vector<forcebound_setting> settings;
  settings.reserve(request.settings.size());
  for (const auto& [key, value] : request.settings) settings.push_back({key.c_str(), value.c_str()});
  std::array<char, FORCEBOUND_TEXT_BYTES> error{};
  const CallInProgress in_progress(functions().name, "open");
  const ThreadsOfDriver threads;
  const int opened = functions().open(settings.data(), settings.size(), &device_, error.data(), error.size());
  if (opened == FORCEBOUND_OK) {
    stop_at_crash_.emplace([this] { stop_at_crash(); });
    return;
  }
  const std::string_view why(error.data(), ::strnlen(error.data(), error.size()));
  throw std::runtime_error("driver '" + text::printable(request.name) +
                           "': " + (why.empty() ? "no device" : text::printable(why)));
}

OpenedDriver::~OpenedDriver() {
  (void)stop();
  stop_at_crash_.reset();
  const CallInProgress in_progress(functions().name, "close");
  try {
    functions().close(device_);
  } catch (...) {  // of a driver in C++; there is nobody left to tell
  }
}

void OpenedDriver::start() {
  const ThreadsOfDriver threads;
  if (call("start", functions().start) == FORCEBOUND_OK) return;
  (void)store_failure("does not start");
  throw std::runtime_error("driver '" + std::string(functions().name) + "': " + std::string(last_error()));
}

bool OpenedDriver::stop() noexcept {
  const CallInProgress in_progress(functions().name, "stop");
  try {
    functions().stop(device_);
    return true;
  } catch (...) {
    return false;
  }
}

/// A call in progress may undo a stop: then once more. The one that has crashed never ends.
void OpenedDriver::stop_at_crash() noexcept {
  constexpr std::chrono::milliseconds kLook{1};
  constexpr int kCallMost = 100;
  (void)stop();
  const bool was_in_use = in_use_;
  for (int looks = 0; looks < kCallMost && in_use_; ++looks) std::this_thread::sleep_for(kLook);
  if (was_in_use) (void)stop();
}

void OpenedDriver::store_error(std::string_view text) noexcept {
  error_bytes_ = std::min(text.size(), error_.size());
  std::copy_n(text.begin(), error_bytes_, error_.begin());
}

bool OpenedDriver::store_failure(std::string_view otherwise) noexcept {
  if (error_stored_) return true;
  const CallInProgress in_progress(functions().name, "last_error");
  const char* text = nullptr;
  try {
    if (functions().last_error != nullptr) text = functions().last_error(device_);
  } catch (...) {
    text = nullptr;
  }
  const bool told = text != nullptr && *text != '\0';
  std::string_view words = told ? std::string_view(text, ::strnlen(text, error_.size())) : otherwise;
  while (words.ends_with('\n')) words.remove_suffix(1);
  store_error(words);
  text::make_printable({error_.data(), error_bytes_});
  return told;
}

}  // namespace forcebound::driver
