#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "forcebound/baselines/later_laws.hpp"
#include "forcebound/baselines/two_port_passivity.hpp"

namespace forcebound::baselines {
namespace {

constexpr std::string_view kReflectionName = "tdpa-er";

/// Time-domain passivity with energy reflection, at the server [Panzirsch, Singh, Ott 2020, from an earlier TDPA-ER of
/// theirs]: no end may return more energy than came from the other one, and what came and is not used goes back. At the
/// device it is TwoPortPassivity. The position follows the device as far as the device's energy pays.
///
/// e from the position to the device, f the environment's answer at the position, taken to be held, E the energy
/// received and not yet used.
///
///     P = -f'e > 0:  e is shortened along f, so that P <= E flows into the environment;  E -= P
///     else           -P goes back to the device
///     where the position is at the device:  a share of E goes back too        reflected
///
/// A position behind the device stores what is missing and catches up, so that no drift remains.
///
/// How sure: a reconstruction. Known from the title and from what is said of it: energy is reflected at the other end,
/// the coupling there still acts as the spring that it is, and positions do not drift, as no controller adjusts a
/// velocity for good. Equations and code were not at hand. Ours: with a server that answers with the environment's
/// force there is no remote robot, so the coupling is the step that the position is behind; the rule by which it
/// reflects; and the share of it.
class EnergyReflectionServerSideLaw final : public control::ServerSideLaw {
 public:
  [[nodiscard]] Vector place(const Received& received) noexcept override {
    unused_.add(from_device_.receive(number_at(received.numbers, 0)));
    share_ = std::clamp(number_at(received.numbers, 1), 0.0, 1.0);
    if (place_.rows() != received.position.rows()) {
      place_ = received.position;
      force_ = Vector::Zero(received.position.rows());
    }
    const Vector behind = received.position - place_;
    const double into_J = -force_.dot(behind);
    const double kept_back_J =
        into_J > 0 && std::isfinite(into_J) ? std::max(0.0, into_J - std::max(0.0, unused_.value_J())) : 0.0;
    if (std::isfinite(into_J)) {
      unused_.add(-(std::max(into_J, 0.0) - kept_back_J));
      back_.add(std::max(-into_J, 0.0));
    }
    place_ += keeping_back(behind, force_, kept_back_J);
    if (!place_.allFinite()) place_ = received.position;
    at_device_ = !(kept_back_J > 0);
    return place_;
  }

  [[nodiscard]] Reply answer(const Vector& force_N) noexcept override {
    force_ = force_N;
    if (at_device_) {
      const double reflected_J = share_ * std::max(0.0, unused_.value_J());
      unused_.add(-reflected_J);
      back_.add(reflected_J);
    }
    return {.force = force_N, .numbers = control::ServerLawNumbers::Constant(1, back_.value_J())};
  }

 private:
  Vector place_;  // no rows: nothing received yet
  Vector force_;
  double share_ = 0;
  bool at_device_ = true;
  control::EnergySum unused_;  // E
  control::EnergySum back_;
  RemoteSum from_device_;
};

}  // namespace

control::LawDescription energy_reflection() {
  std::vector<control::LawParameter> parameters = two_port_damper();
  parameters.push_back({.name = "reflected_share",
                        .purpose = "share of the energy not used at the server that goes back with an answer",
                        .most = 1,
                        .standard = [](const control::DeviceFacts&) { return 1.0; }});
  return {.name = std::string(kReflectionName),
          .summary = "time-domain passivity with delay: unused energy is reflected, positions do not drift",
          .reference = "Panzirsch, Singh, Ott 2020",
          .certainty = control::LawCertainty::reconstruction,
          .parameters = std::move(parameters),
          .make =
              [](const control::DeviceFacts& facts, const control::LawOptions& options) {
                const double share = options.parameters.at("reflected_share");
                return std::make_unique<TwoPortPassivity>(kReflectionName, facts, options.parameters,
                                                          control::ServerLawNumbers::Constant(1, share));
              },
          .make_server_side = [](int) { return std::make_unique<EnergyReflectionServerSideLaw>(); }};
}

}  // namespace forcebound::baselines
