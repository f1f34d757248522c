#pragma once

#include <cstdint>
#include <variant>

#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/random.hpp"

namespace forcebound::netem {

/// Decides for each packet whether it is lost. Allocates nothing.
class LossModel {
 public:
  LossModel(const Loss& loss, Random& random) noexcept;

  bool loses_next(Random& random) noexcept;

 private:
  struct Never {};
  struct GilbertElliott {
    GilbertElliottLoss parameters;
    bool bad = false;
  };
  struct FourState {
    enum class State : std::uint8_t { good, good_in_burst, burst_loss, isolated_loss };
    FourStateLoss parameters;
    State state = State::good;
  };
  using Model = std::variant<Never, Event, GilbertElliott, FourState>;

  static Model make(const Loss& loss, Random& random) noexcept;
  static bool step(Never&, Random&) noexcept { return false; }
  static bool step(Event& event, Random& random) noexcept { return event.happens(random); }
  static bool step(GilbertElliott& model, Random& random) noexcept;
  static bool step(FourState& model, Random& random) noexcept;

  Model model_;
};

/// The share of packets that a model loses in a long run, measured: closed forms do not exist for all of them.
Share measured_loss(const Loss& loss);

}  // namespace forcebound::netem
