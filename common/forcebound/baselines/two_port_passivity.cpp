#include "forcebound/baselines/two_port_passivity.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

constexpr std::string_view kTwoPortName = "tdpa-2port";

/// The server-side law: velocity is its input, so its controller adjusts velocity.
///
/// d the step of the device since the motion before, f the environment's answer there, taken to be held.
///
///     P = -f'd > 0 flows into the environment:  E_out += P,  else  E_in -= P
///     P > E_in(device) - E_out:  d += beta f, so that just the available energy flows
///
/// So E_out never exceeds E_in(device). Shortened steps are never made up: the position drifts away from the device,
/// which is the cost of this law.
class TwoPortServerSideLaw final : public control::ServerSideLaw {
 public:
  [[nodiscard]] Vector place(const Received& received) noexcept override {
    available_.add(from_device_.receive(number_at(received.numbers, 0)));
    if (place_.rows() != received.position.rows()) {
      place_ = device_ = received.position;
      force_ = Vector::Zero(received.position.rows());
    }
    const Vector d = received.position - device_;
    device_ = received.position;
    const double into_J = -force_.dot(d);
    if (!std::isfinite(into_J)) {
      place_ = device_;  // an overflow is a fault, not a motion
    } else if (into_J > 0) {
      const double kept_back_J = std::clamp(into_J - available_.value_J(), 0.0, into_J);
      available_.add(kept_back_J - into_J);
      place_ += keeping_back(d, force_, kept_back_J);
    } else {
      in_.add(-into_J);
      place_ += d;
    }
    if (!place_.allFinite()) place_ = device_;
    return place_;
  }

  [[nodiscard]] Reply answer(const Vector& force_N) noexcept override {
    force_ = force_N;
    return {.force = force_N, .numbers = control::ServerLawNumbers::Constant(1, in_.value_J())};
  }

 private:
  Vector place_;   // no rows: nothing received yet
  Vector device_;  // at the motion before
  Vector force_;
  control::EnergySum in_;
  control::EnergySum available_;  // E_in(device) - E_out
  RemoteSum from_device_;
};

}  // namespace

control::LawDescription two_port_passivity() {
  return {.name = std::string(kTwoPortName),
          .summary = "time-domain passivity with delay: observers at both ends exchange energies; positions drift",
          .reference = "Ryu & Preusche 2007; Ryu, Artigas & Preusche 2010",
          .certainty = control::LawCertainty::likely,
          .parameters = two_port_damper(),
          .make =
              [](const control::DeviceFacts& facts, const control::LawOptions& options) {
                return std::make_unique<TwoPortPassivity>(kTwoPortName, facts, options.parameters);
              },
          .make_server_side = [](int) { return std::make_unique<TwoPortServerSideLaw>(); }};
}

}  // namespace forcebound::baselines
