#include "tests/tools/netem/loss_model.hpp"

namespace forcebound::netem {

LossModel::LossModel(const Loss& loss, Random& random) noexcept : model_(make(loss, random)) {}

LossModel::Model LossModel::make(const Loss& loss, Random& random) noexcept {
  if (const auto* independent = std::get_if<RandomLoss>(&loss)) return Event(independent->chance, random);
  if (const auto* bursts = std::get_if<GilbertElliottLoss>(&loss)) return GilbertElliott{*bursts};
  if (const auto* states = std::get_if<FourStateLoss>(&loss)) return FourState{*states};
  return Never{};
}

bool LossModel::loses_next(Random& random) noexcept {
  return std::visit([&](auto& model) { return step(model, random); }, model_);
}

bool LossModel::step(GilbertElliott& model, Random& random) noexcept {
  const GilbertElliottLoss& p = model.parameters;
  // The state before the transition decides this packet.
  const bool was_bad = model.bad;
  if (random.draw() < (was_bad ? p.bad_to_good : p.good_to_bad)) model.bad = !was_bad;
  if (was_bad) return random.draw() > kCertain - p.bad_loss;
  return random.draw() < p.good_loss;
}

bool LossModel::step(FourState& model, Random& random) noexcept {
  using State = FourState::State;
  const FourStateLoss& p = model.parameters;
  const std::uint64_t draw = random.draw();  // 64 bits: sums of two shares do not wrap
  switch (model.state) {
    case State::good:
      if (draw < p.p14) {
        model.state = State::isolated_loss;
      } else if (draw < std::uint64_t{p.p13} + p.p14) {
        model.state = State::burst_loss;
      }
      break;
    case State::good_in_burst:
      if (draw < p.p23) model.state = State::burst_loss;
      break;
    case State::burst_loss:
      if (draw < p.p32) {
        model.state = State::good_in_burst;
      } else if (draw < std::uint64_t{p.p31} + p.p32) {
        model.state = State::good;
      }
      break;
    case State::isolated_loss:
      model.state = State::good;
      break;
  }
  return model.state == State::burst_loss || model.state == State::isolated_loss;
}

Share measured_loss(const Loss& loss) {
  constexpr std::uint64_t kPackets = 1'000'000;
  Random random(1);
  LossModel model(loss, random);
  std::uint64_t lost = 0;
  for (std::uint64_t i = 0; i < kPackets; ++i) lost += model.loses_next(random) ? 1U : 0U;
  return static_cast<Share>(lost * kCertain / kPackets);
}

}  // namespace forcebound::netem
