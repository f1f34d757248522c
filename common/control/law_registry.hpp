#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/law.hpp"

namespace forcebound::control {

/// The laws one can ask for by name. A value: a program takes `published_laws()`, adds its own and hands it on.
///
///     auto laws = published_laws();
///     laws.add("mine", "does nothing at all", [](const DeviceFacts& facts) { return std::make_unique<MyLaw>(facts);
///     });
class LawRegistry {
 public:
  using Factory = std::function<std::unique_ptr<PassivityLaw>(const DeviceFacts&)>;

  /// @throws std::invalid_argument if there is a law of that name.
  void add(std::string name, std::string summary, Factory factory);

  /// @throws std::invalid_argument naming the known laws, or what the law refuses about the device.
  [[nodiscard]] std::unique_ptr<PassivityLaw> make(std::string_view name, const DeviceFacts& facts) const;

  [[nodiscard]] std::vector<std::string> names() const;

  /// "NAME  what it does", a line each, for --help.
  [[nodiscard]] std::string help() const;

 private:
  struct Entry {
    std::string name;
    std::string summary;
    Factory factory;
  };
  std::vector<Entry> entries_;
};

/// `none`, `fba-less` and `fba-more` [Kim 2015].
LawRegistry published_laws();

}  // namespace forcebound::control
