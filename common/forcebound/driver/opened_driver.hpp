#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "forcebound/driver/crash.hpp"
#include "forcebound/driver/driver_library.hpp"
#include "forcebound/driver/driver_request.hpp"

namespace forcebound::driver {

/// A device or robot that a driver has opened, and why its last call failed. At the end it is stopped and closed, and
/// where a driver crashes it is stopped (catch_crashes).
///
/// Real time: what is noexcept allocates nothing, and takes as long as the driver. Used by one thread, but for `stop`.
class OpenedDriver {
 public:
  /// @throws std::runtime_error in one line: what the driver says
  OpenedDriver(std::shared_ptr<const DriverLibrary> library, const DriverRequest& request);
  ~OpenedDriver();
  OpenedDriver(const OpenedDriver&) = delete;
  OpenedDriver& operator=(const OpenedDriver&) = delete;

  [[nodiscard]] const forcebound_driver& functions() const noexcept { return library_->functions(); }
  [[nodiscard]] forcebound_device* device() const noexcept { return device_; }

  /// @throws std::runtime_error with the reason
  void start();

  /// What `function` returns; FORCEBOUND_FAILED, and noted, where a driver in C++ throws, or one has crashed.
  /// @param name of the function, as the interface calls it
  template <class... Arguments>
  int call(const char* name, int (*function)(forcebound_device*, Arguments...), Arguments... arguments) noexcept {
    const InUse in_use(in_use_);
    error_stored_ = true;
    if (has_crashed()) {
      store_error("its driver has crashed");
      return FORCEBOUND_FAILED;
    }
    const CallInProgress in_progress(functions().name, name);
    try {
      const int result = function(device_, arguments...);
      error_stored_ = false;
      return result;
    } catch (...) {
      store_error("the driver threw an exception");
      return FORCEBOUND_FAILED;
    }
  }

  /// Of any thread. @return false: a driver in C++ threw
  bool stop() noexcept;

  void store_error(std::string_view text) noexcept;

  /// Notes the driver's own reason after a call that failed, in one line, or `otherwise`.
  /// @returns whether the driver gave one, or threw
  bool store_failure(std::string_view otherwise) noexcept;

  [[nodiscard]] std::string_view last_error() const noexcept { return {error_.data(), error_bytes_}; }

 private:
  struct InUse {
    explicit InUse(std::atomic<bool>& flag) noexcept : in_use(flag) { in_use = true; }
    ~InUse() { in_use = false; }
    InUse(const InUse&) = delete;
    InUse& operator=(const InUse&) = delete;
    std::atomic<bool>& in_use;
  };

  void stop_at_crash() noexcept;

  std::shared_ptr<const DriverLibrary> library_;
  forcebound_device* device_ = nullptr;
  bool error_stored_ = false;  // why the last call failed
  std::array<char, FORCEBOUND_TEXT_BYTES> error_{};
  std::size_t error_bytes_ = 0;
  std::atomic<bool> in_use_{false};
  std::optional<StopAtCrash> stop_at_crash_{};  // last, so that it ends first
};

}  // namespace forcebound::driver
