#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/law.hpp"

namespace forcebound::control {

/// How much of the energy that the device dissipated a law may keep for later.
enum class EnergyMemory : std::uint8_t {
  capped,  ///< what the largest force can ever need: stops ringing
  full,    ///< all of it
};

/// What one may choose about a law. A law takes what it knows and ignores the rest.
struct LawOptions {
  EnergyMemory memory = EnergyMemory::capped;
};

/// The laws one can ask for by name. A value: a program takes `shipped_laws()`, adds its own and hands it on.
///
///     auto laws = shipped_laws();
///     laws.add("mine", "does nothing at all",
///              [](const DeviceFacts& facts, const LawOptions&) { return std::make_unique<MyLaw>(facts); });
class LawRegistry {
 public:
  using Factory = std::function<std::unique_ptr<PassivityLaw>(const DeviceFacts&, const LawOptions&)>;

  /// @throws std::invalid_argument if there is a law of that name.
  void add(std::string name, std::string summary, Factory factory);

  /// @throws std::invalid_argument naming the known laws, or what the law refuses about the device.
  [[nodiscard]] std::unique_ptr<PassivityLaw> make(std::string_view name, const DeviceFacts& facts,
                                                   const LawOptions& options = {}) const;

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

/// The published laws and `fba-exact`, the default of the programs.
LawRegistry shipped_laws();

}  // namespace forcebound::control
