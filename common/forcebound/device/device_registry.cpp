#include "forcebound/device/device_registry.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_family.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::device {

DeviceRegistry DeviceRegistry::standard() {
  DeviceRegistry devices;
  devices.add(simulated_devices());
  return devices;
}

void DeviceRegistry::add(DeviceFamily family) {
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("device family '" + family.name + "' " + why);
  };
  if (family.name.empty()) refuse("must have a name");
  if (!family.facts || !family.make) refuse("must have functions for facts and to make a device");
  const auto known_names = names();
  for (const std::string& name : family.names) {
    if (std::ranges::count(known_names, name) > 0) refuse("has a device '" + name + "', which is already registered");
  }
  const bool files_taken = std::ranges::any_of(families_, &DeviceFamily::takes_files);
  if (family.takes_files && files_taken) refuse("takes files, but another family already does");
  families_.push_back(std::move(family));
}

DeviceRequest DeviceRegistry::completed(DeviceRequest request) const {
  for (const DeviceFamily& family : families_) {
    if (!request.device.empty()) break;
    if (family.complete) family.complete(request);
  }
  const DeviceFamily* family = find(request.device);
  if (family != nullptr && family->complete) family->complete(request);
  return request;
}

control::DeviceFacts DeviceRegistry::facts(const std::string& name_or_file) const {
  return known(name_or_file).facts(name_or_file);
}

std::unique_ptr<HapticDevice> DeviceRegistry::make(const DeviceRequest& request) const {
  return known(request.device).make(request);
}

std::vector<std::string> DeviceRegistry::names() const {
  std::vector<std::string> all;
  for (const DeviceFamily& family : families_) all.insert(all.end(), family.names.begin(), family.names.end());
  return all;
}

std::string DeviceRegistry::help() const {
  std::string text;
  for (const DeviceFamily& family : families_) text += family.help;
  return text;
}

const DeviceFamily* DeviceRegistry::find(const std::string& name_or_file) const {
  const auto knows = [&](const DeviceFamily& family) { return family.knows && family.knows(name_or_file); };
  const auto by_itself = std::ranges::find_if(families_, knows);
  if (by_itself != families_.end()) return &*by_itself;
  const bool file = names_a_file(name_or_file);
  const auto serves = [&](const DeviceFamily& family) {
    return file ? family.takes_files : std::ranges::count(family.names, name_or_file) > 0;
  };
  const auto found = std::ranges::find_if(families_, serves);
  return found == families_.end() ? nullptr : &*found;
}

const DeviceFamily& DeviceRegistry::known(const std::string& name_or_file) const {
  if (const DeviceFamily* family = find(name_or_file)) return *family;
  const bool files = std::ranges::any_of(families_, &DeviceFamily::takes_files);
  std::string hints;
  for (const DeviceFamily& family : families_) hints += family.hint.empty() ? "" : "; " + family.hint;
  throw std::invalid_argument("unknown device '" + name_or_file + "'" + text::suggestion(name_or_file, names()) +
                              (files ? "; or the path of a .toml file" : "") + hints);
}

}  // namespace forcebound::device
