#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/control/server_side_law.hpp"

namespace forcebound::control {

/// How much of the energy that the device dissipated a law may keep for later.
enum class EnergyMemory : std::uint8_t {
  capped,  ///< what the largest force can ever need: stops ringing
  full,    ///< all of it
};

/// Numbers by name, as they are chosen.
using LawParameters = std::map<std::string, double, std::less<>>;

/// What can be chosen about a law. A law takes what it knows of `memory`; a parameter that it does not have is
/// refused.
struct LawOptions {
  EnergyMemory memory = EnergyMemory::capped;
  LawParameters parameters{};
};

/// A number that can be chosen about a law.
struct LawParameter {
  std::string name;     ///< with its unit: "coupling_N_per_m"
  std::string purpose;  ///< for --help, a line
  double least = 0;     ///< accepted from here
  double most = std::numeric_limits<double>::max();
  std::vector<double> choices{};                       ///< if not empty, only these
  std::function<double(const DeviceFacts&)> standard;  ///< from the device alone, never from a scene or a network

  [[nodiscard]] bool accepts(double value) const;

  /// "0.5 to 2", "2002 or 2004", ">= 0".
  [[nodiscard]] std::string accepted() const;
};

/// How well the published algorithm is known.
enum class LawCertainty : std::uint8_t {
  published,       ///< as published
  likely,          ///< the published idea; details are ours
  reconstruction,  ///< built from a description; its authors may have done otherwise
};

/// What a law promises of P(t), whatever the environment and the network do. A law with a server-side law trusts
/// it: false sums from there would be spent as energy.
enum class LawClaim : std::uint8_t {
  nothing,
  passive_if_ideal,  ///< P >= 0 on straight axes with ideal encoders, punctual ticks, and forces in effect at the
                     ///< reading
  passive,           ///< P >= 0 on any device that is within its facts' bounds
};

/// A law as one can ask for it by name; said in --help.
struct LawDescription {
  using Make = std::function<std::unique_ptr<PassivityLaw>(const DeviceFacts&, const LawOptions&)>;
  using MakeServerSide = std::function<std::unique_ptr<ServerSideLaw>(int degrees_of_freedom)>;

  std::string name;
  std::string summary;      ///< for --help, a line
  std::string reference{};  ///< who, when; empty: ours
  LawCertainty certainty = LawCertainty::published;
  LawClaim claim = LawClaim::nothing;
  bool shortens = false;  ///< promises that its force is the request, made shorter at most
  std::vector<LawParameter> parameters{};
  Make make;  ///< is given every parameter; throws std::invalid_argument for what it cannot work with
  MakeServerSide make_server_side{};  ///< its server-side law; empty: it has none
};

}  // namespace forcebound::control
