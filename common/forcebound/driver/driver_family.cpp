#include "forcebound/driver/driver_family.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/driver/driver_device.hpp"
#include "forcebound/driver/first_opening.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::driver {
namespace {

std::unique_ptr<DriverDevice> open(const std::string& file, const DriverRequest& request) {
  std::optional<device::RealDevice> own;
  if (!request.facts_file.empty()) {
    own = device::parse_facts(text::read_file(request.facts_file), request.facts_file);
  }
  return std::make_unique<DriverDevice>(std::make_shared<const DriverLibrary>(file, request.name), request,
                                        std::move(own));
}

/// One device at a time, between the question for its facts and the one for the device.
class Opener {
 public:
  explicit Opener(std::vector<std::string> folders) : folders_(std::move(folders)) {}

  const control::DeviceFacts& facts(const std::string& request) {
    if (device_ == nullptr || request_ != request) {
      device_ = opened(request);
      request_ = request;
    }
    return device_->facts();
  }

  std::unique_ptr<device::HapticDevice> make(const device::DeviceRequest& request) {
    if (!request.hand.empty()) {
      throw std::invalid_argument("'" + request.hand + "' is for simulated devices; device '" + request.device +
                                  "' is moved by a person");
    }
    (void)facts(request.device);
    device_->run_at(request.rate_Hz);
    return std::move(device_);
  }

 private:
  [[nodiscard]] std::unique_ptr<DriverDevice> opened(const std::string& text) const {
    const DriverRequest request = DriverRequest::parse(text);
    const auto file = find_driver(request.name, folders_);
    if (!file) throw std::runtime_error("driver '" + request.name + "' is gone");
    expect_to_survive(*file, request, [&] { (void)open(*file, request); });
    return open(*file, request);
  }

  std::vector<std::string> folders_;
  std::string request_;
  std::unique_ptr<DriverDevice> device_;
};

std::string help_of(const std::vector<std::string>& names) {
  return "Devices behind drivers (--device NAME[:KEY=VALUE,...]): " +
         (names.empty() ? "none found" : text::join(names)) +
         ". The key facts=FILE.toml replaces the driver's facts.\n";
}

}  // namespace

device::DeviceFamily driver_family(std::vector<std::string> folders) {
  const std::vector<std::string> names = drivers_in(folders);
  std::string looked = "drivers are looked for in " + text::join(folders) + "; FORCEBOUND_DEVICE_PATH adds folders";
  const auto opener = std::make_shared<Opener>(folders);
  return {.name = "drivers",
          .names = names,
          .help = help_of(names),
          .hint = std::move(looked),
          .knows =
              [folders = std::move(folders)](const std::string& device) {
                return find_driver(device.substr(0, device.find(':')), folders).has_value();
              },
          .facts = [opener](const std::string& device) { return opener->facts(device); },
          .make = [opener](const device::DeviceRequest& request) { return opener->make(request); }};
}

}  // namespace forcebound::driver
