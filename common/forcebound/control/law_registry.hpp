#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/law_description.hpp"

namespace forcebound::control {

/// The laws one can ask for by name. A value: a program takes `force_bounding_laws()` or `baselines::shipped_laws()`,
/// adds its own and hands it on.
///
///     auto laws = force_bounding_laws();
///     laws.add({.name = "mine",
///               .summary = "does nothing at all",
///               .make = [](const DeviceFacts& facts, const LawOptions&) { return std::make_unique<MyLaw>(facts); }});
class LawRegistry {
 public:
  /// @throws std::invalid_argument if there is a law of that name, nothing to make it with, or a parameter
  /// without a standard value.
  void add(LawDescription law);

  /// Parameters that are not in `options` are what the law's description says for this device.
  /// @throws std::invalid_argument naming the known laws or parameters, the value that is out of range, or what the law
  /// refuses about the device.
  [[nodiscard]] std::unique_ptr<PassivityLaw> make(std::string_view name, const DeviceFacts& facts,
                                                   const LawOptions& options = {}) const;

  /// Why `make` would refuse; empty: it would not.
  /// @throws std::invalid_argument naming the known laws.
  [[nodiscard]] std::string refusal(std::string_view name, const DeviceFacts& facts,
                                    const LawOptions& options = {}) const;

  /// The server-side law of the law of that name; null if it has none.
  [[nodiscard]] std::unique_ptr<ServerSideLaw> make_server_side(std::string_view law, int degrees_of_freedom) const;

  /// Every parameter of the law: as in `chosen`, or as described for this device.
  /// @throws std::invalid_argument as `make`.
  [[nodiscard]] LawParameters parameters(std::string_view name, const DeviceFacts& facts,
                                         const LawParameters& chosen = {}) const;

  /// @throws std::invalid_argument naming the known laws.
  [[nodiscard]] const LawDescription& find(std::string_view name) const;

  [[nodiscard]] std::vector<std::string> names() const;

  /// "NAME  what it does", a line each, for --help.
  [[nodiscard]] std::string help() const;

  /// What a law promises of P where nobody measures it, and of which facts that takes: "P >= 0 as long as ...". Empty:
  /// it promises nothing.
  [[nodiscard]] std::string guarantee(std::string_view name) const;

  /// Everything about one law: what it does, after whom, how sure, what it promises and its parameters.
  [[nodiscard]] std::string help(std::string_view name) const;

  /// That, with the standard values for a device, or why it refuses the device.
  [[nodiscard]] std::string help(std::string_view name, const DeviceFacts& facts) const;

 private:
  std::vector<LawDescription> laws_;
};

/// `none`, `fba-less` and `fba-more` [Kim 2015].
LawRegistry published_laws();

/// The published laws and `fba-exact`, the default of the programs.
LawRegistry force_bounding_laws();

}  // namespace forcebound::control
