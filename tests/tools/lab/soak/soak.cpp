#include "tests/tools/lab/soak/soak.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "tests/tools/lab/soak/invariants.hpp"
#include "tests/tools/lab/soak/lying_model.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::lab {
namespace {

/// Counts late ticks, and hashes all ticks (FNV-1a).
class Witness final : public record::TickSink {
 public:
  explicit Witness(time::Nanoseconds period) : limit_(period + record::kLateBy) {}
  void on_tick(const record::TickRecord& tick) noexcept override {
    late += tick.interval > limit_;
    add_to_digest(tick.time.count());
    for (const double value : tick.applied) add_to_digest(value);
    for (const double value : tick.joint) add_to_digest(value);
    add_to_digest(tick.energy_J);
    add_to_digest(tick.audit_J);
  }
  void on_force(const record::ForceRecord& force) noexcept override { add_to_digest(force.receive_time.count()); }

  std::uint64_t late = 0;
  std::uint64_t digest = 0xcbf29ce484222325;

 private:
  template <typename Value>
  void add_to_digest(const Value& value) noexcept {
    for (const unsigned char byte : std::bit_cast<std::array<unsigned char, sizeof(Value)>>(value)) {
      digest = (digest ^ byte) * 0x100000001b3;
    }
  }

  time::Nanoseconds limit_;
};

/// What a server that lies sends, with a checksum that agrees: pieces of the scene that are changed, of another number
/// or session, cut, or lost; answers with local models of their own, each for some answers, and with another clock.
class Liar {
 public:
  explicit Liar(const SoakCase& drawn)
      : pieces_(drawn.pieces_changed),
        models_(drawn.models_lie),
        state_(std::make_shared<State>(
            State{.read = {}, .write = {}, .draw = sim::Draw(drawn.settings.seed ^ 0x7f4a7c15)})) {
    state_->share_of_pieces = state_->draw.one_of({0.02, 0.3, 1.0});
  }

  std::span<const std::byte> operator()(std::span<const std::byte> datagram, time::Nanoseconds) {
    const auto decoded = state_->read.decode(datagram);
    const auto* const message = std::get_if<wire::Message>(&decoded);
    if (message == nullptr) return datagram;
    if (const auto* const piece = std::get_if<wire::ScenePiece>(message); piece != nullptr && pieces_)
      return changed(*piece);
    if (const auto* const force = std::get_if<wire::EnvironmentForce>(message); force != nullptr && models_) {
      return state_->write.encode(changed(*force));
    }
    return datagram;
  }

 private:
  struct State {
    wire::Codec read;
    wire::Codec write;
    sim::Draw draw;
    double share_of_pieces = 1;  // that are changed
    local_model::LocalModel model{};
    time::Nanoseconds ahead{0};  // of the clock
  };

  std::span<const std::byte> changed(wire::ScenePiece piece) {
    sim::Draw& draw = state_->draw;
    std::vector<std::byte> content(piece.content.begin(), piece.content.end());
    if (draw.chance(state_->share_of_pieces)) {
      switch (draw.index(5)) {
        case 0:
          if (!content.empty()) content[draw.index(content.size())] ^= std::byte{32};
          break;
        case 1:
          piece.number = static_cast<std::uint32_t>(draw.one_of<std::uint64_t>({draw.index(8), draw.seed()}));
          break;
        case 2:
          ++piece.session;
          break;
        case 3:
          content.resize(content.size() / 2);
          break;
        default:  // lost, as what has not even a header
          return state_->write.encode(piece).first(1);
      }
    }
    piece.content = content;
    return state_->write.encode(piece);
  }

  /// The counts are the server's, since the invariants compare them with the client's.
  wire::EnvironmentForce changed(wire::EnvironmentForce force) {
    sim::Draw& draw = state_->draw;
    // A lie that stays moves masses and relaxes surfaces further than one that is another each time.
    if (draw.chance(0.3)) state_->model = lying_model(draw, force);
    if (draw.chance(0.02)) {
      const double most_s = draw.one_of({0.0, 0.01, 1.0, 1e9});
      state_->ahead = draw.duration(-most_s, most_s);
    }
    force.answer.model = state_->model;
    const time::Nanoseconds taken = force.server_send_time - force.server_receive_time;
    force.server_receive_time = std::max(time::Nanoseconds{0}, force.server_receive_time + state_->ahead);
    force.server_send_time = force.server_receive_time + taken;
    return force;
  }

  bool pieces_;
  bool models_;
  std::shared_ptr<State> state_;
};

}  // namespace

std::string law_of(std::uint64_t seed, SoakTip tip) {
  const control::LawRegistry shipped = baselines::shipped_laws();
  std::vector<std::string> laws = shipped.names();
  if (tip == SoakTip::tool) {
    const control::DeviceFacts facts = device::load_device("arm-6dof").facts;
    std::erase_if(laws, [&](const std::string& law) { return !shipped.refusal(law, facts).empty(); });
  }
  // Another stream than the case's own, so that the case does not depend on the law.
  return laws[sim::Draw(~seed).index(laws.size())];
}

SoakResult soak(std::uint64_t seed, const std::string& law, SoakTip tip) {
  return soak(draw_soak_case(seed, law, tip));
}

SoakResult soak(const SoakCase& drawn) {
  Invariants invariants(drawn);
  Witness witness(time::from_seconds(drawn.settings.device.facts.period_s));
  sim::ClosedLoop loop(drawn.settings, {&invariants, &witness});
  if (drawn.pieces_changed || drawn.models_lie) loop.network().set_tamper(Liar(drawn));
  loop.run(drawn.duration);
  const bool active = loop.session().state() == client::SessionState::active;
  (void)loop.close();
  const record::RunTotals totals = loop.totals();
  invariants.finish(totals, active, loop.server()->counters());
  return {.broken = invariants.broken(),
          .environment = drawn.environment,
          .passive = drawn.passive,
          .beyond_bounds = drawn.beyond_bounds,
          .least_P_J = invariants.least_P_J(),
          .digest = witness.digest,
          .virtual_s = time::to_seconds(drawn.duration),
          .ticks = invariants.ticks(),
          .recomputed = invariants.recomputed(),
          .late_ticks = witness.late,
          .released = totals.released_by_device,
          .withdrawn = totals.withdrawn_forces,
          .reconnects = totals.reconnects,
          .lost = totals.lost_up + totals.lost_down};
}

}  // namespace forcebound::lab
