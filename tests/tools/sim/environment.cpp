#include "tests/tools/sim/environment.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>

#include "forcebound/control/rotation.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/text/names.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

Vector along(const Vector& direction, double length) {
  const double norm = direction.norm();
  return norm > 0 ? Vector(direction * (length / norm)) : Vector::Zero(direction.rows());
}

/// Inputs of an adversary.
struct View {
  Nanoseconds time;         ///< true
  const Vector& position;   ///< of the motion it answers [m]
  const Vector& velocity;   ///< of the tip, true, now [m/s]
  const Vector& own_force;  ///< the scene's force [N]
  double ledger_J = 0;      ///< energy that the client's law may spend
};

/// Answers as the scene does, but with a force of its own.
class Adversary : public server::Environment {
 public:
  void set_honest(std::unique_ptr<server::Environment> honest, std::function<Truth()> truth, double lever_m) {
    honest_ = std::move(honest);
    truth_ = std::move(truth);
    lever_m_ = lever_m;
  }

  server::Answer respond(const server::Motion& motion) noexcept final {
    server::Answer answer = honest_->respond(motion);
    const Truth truth = truth_();
    const bool turns = lever_m_ > 0 && truth.turning.rows() > 0 && motion.handle.orientation;
    const auto turn_or_none = [&](const Vector& turn) { return turns ? turn : Vector(); };
    const Vector turned = turns ? Vector(control::rotation_vector(Eigen::Quaterniond::Identity(),
                                                                  control::quaternion_of(*motion.handle.orientation)))
                                : Vector();
    const Vector own_torque_N_m = turn_or_none(control::translation_of(answer.torque_N_m));
    const Vector chosen = force({.time = truth.time,
                                 .position = with_turn(motion.position, turned, lever_m_),
                                 .velocity = with_turn(truth.velocity, turn_or_none(truth.turning), lever_m_),
                                 .own_force = with_turn(answer.force, own_torque_N_m, 1 / lever_m_),
                                 .ledger_J = truth.ledger_J});
    if (!is_hostile()) return answer;
    answer.force = chosen.head(answer.force.rows());
    if (turns) answer.torque_N_m = lever_m_ * chosen.tail(turned.rows());
    // Where the client renders the scene itself, the same comes beside it.
    answer.server_parts_N = answer.force;
    return answer;
  }

  std::span<const std::string* const> quarantined() const noexcept final { return honest_->quarantined(); }

  server::EnvironmentFaults faults() const noexcept final { return honest_->faults(); }

 private:
  virtual Vector force(const View& view) = 0;
  [[nodiscard]] virtual bool is_hostile() const { return true; }

  std::unique_ptr<server::Environment> honest_;
  std::function<Truth()> truth_;
  double lever_m_ = 0;
};

class Honest final : public Adversary {
 public:
  Vector force(const View& view) override { return view.own_force; }

 private:
  [[nodiscard]] bool is_hostile() const override { return false; }
};

/// Any force, another one on each motion.
class Random final : public Adversary {
 public:
  explicit Random(const EnvironmentSetting& setting) : draw_(setting.seed), force_N_max_(setting.force_N_max) {}
  Vector force(const View& view) override {
    return draw_.direction(view.position.rows(), draw_.number(0, force_N_max_));
  }

 private:
  Draw draw_;
  double force_N_max_;
};

/// Pushes away from where it first saw the device.
class NegativeStiffness final : public Adversary {
 public:
  explicit NegativeStiffness(const EnvironmentSetting& setting)
      : stiffness_N_per_m_(Draw(setting.seed).one_of({1e3, 1e4, 1e5})) {}
  Vector force(const View& view) override {
    if (!centre_) centre_ = view.position;
    return stiffness_N_per_m_ * (view.position - *centre_);
  }

 private:
  double stiffness_N_per_m_;
  std::optional<Vector> centre_;
};

/// Pushes along the motion between the last two readings.
class NegativeDamping final : public Adversary {
 public:
  explicit NegativeDamping(const EnvironmentSetting& setting)
      : damping_N_s_per_m_(Draw(setting.seed).one_of({10.0, 100.0, 1000.0})) {}
  Vector force(const View& view) override {
    Vector force = Vector::Zero(view.position.rows());
    if (before_ && view.time > time_) {
      force = damping_N_s_per_m_ * (view.position - *before_) / time::to_seconds(view.time - time_);
    }
    before_ = view.position;
    time_ = view.time;
    return force;
  }

 private:
  double damping_N_s_per_m_;
  std::optional<Vector> before_;
  Nanoseconds time_{0};
};

/// The largest force, along the true motion.
class BangBang final : public Adversary {
 public:
  explicit BangBang(const EnvironmentSetting& setting) : force_N_max_(setting.force_N_max) {}
  Vector force(const View& view) override { return along(view.velocity, force_N_max_); }

 private:
  double force_N_max_;
};

/// A stiff spring to where it first saw the device, with the device's position some time ago.
class DelayedWall final : public Adversary {
 public:
  explicit DelayedWall(const EnvironmentSetting& setting) {
    Draw draw(setting.seed);
    stiffness_N_per_m_ = draw.one_of({3e3, 3e4, 3e5});
    delay_ = draw.one_of({2ms, 10ms, 50ms});
  }
  Vector force(const View& view) override {
    if (!centre_) centre_ = view.position;
    past_.emplace_back(view.time, view.position);
    while (past_.size() > 1 && past_[1].first <= view.time - delay_) past_.pop_front();
    return -stiffness_N_per_m_ * (past_.front().second - *centre_);
  }

 private:
  double stiffness_N_per_m_ = 0;
  Nanoseconds delay_{0};
  std::optional<Vector> centre_;
  std::deque<std::pair<Nanoseconds, Vector>> past_;
};

/// Alternating directions.
class Switching final : public Adversary {
 public:
  explicit Switching(const EnvironmentSetting& setting) : draw_(setting.seed), force_N_max_(setting.force_N_max) {}
  Vector force(const View& view) override {
    if (direction_.rows() == 0) direction_ = draw_.direction(view.position.rows(), force_N_max_);
    return direction_ = -direction_;
  }

 private:
  Draw draw_;
  double force_N_max_;
  Vector direction_;
};

/// Reads the law's ledger: lets the hand fill it with zero requests, and then spends all of it along the true motion.
/// In between it shakes the device by less than friction and law would bound, so that an encoder flickers.
class Greedy final : public Adversary {
 public:
  explicit Greedy(const EnvironmentSetting& setting)
      : draw_(setting.seed),
        force_N_max_(setting.force_N_max),
        filled_J_(draw_.one_of({1e-7, 1e-5, 1e-3})),
        dither_N_(draw_.one_of({0.0, 0.05, 0.5})) {}
  Vector force(const View& view) override {
    if (!raiding_ && view.ledger_J > filled_J_) raiding_ = true;
    if (raiding_ && view.ledger_J <= 1e-2 * filled_J_) raiding_ = false;
    if (raiding_) return along(view.velocity, force_N_max_);
    return draw_.direction(view.position.rows(), dither_N_);
  }

 private:
  Draw draw_;
  double force_N_max_;
  double filled_J_;
  double dither_N_;
  bool raiding_ = false;
};

/// The forces of another run, repeated.
class Replayed final : public Adversary {
 public:
  explicit Replayed(const EnvironmentSetting& setting) : forces_(setting.other_run) {}
  Vector force(const View& view) override {
    if (forces_.empty()) return view.own_force;
    const Vector& force = forces_[next_++ % forces_.size()];
    return force.rows() == view.position.rows() ? force : view.own_force;
  }

 private:
  std::vector<Vector> forces_;
  std::size_t next_ = 0;
};

struct Kind {
  std::string_view name;
  std::string_view what;
  std::unique_ptr<Adversary> (*make)(const EnvironmentSetting&);
};

template <typename Hostile>
std::unique_ptr<Adversary> make(const EnvironmentSetting& setting) {
  if constexpr (std::is_constructible_v<Hostile, const EnvironmentSetting&>) {
    return std::make_unique<Hostile>(setting);
  } else {
    return std::make_unique<Hostile>();
  }
}

constexpr std::array kKinds{
    Kind{"honest", "the scene's force", make<Honest>},
    Kind{"random", "a random force on each motion", make<Random>},
    Kind{"negative-stiffness", "pushes away from where the motion began", make<NegativeStiffness>},
    Kind{"negative-damping", "pushes along the motion between readings", make<NegativeDamping>},
    Kind{"bang-bang", "the largest force, along the true motion", make<BangBang>},
    Kind{"delayed-wall", "a stiff spring to a delayed position", make<DelayedWall>},
    Kind{"switching", "the largest force, reversed on each motion", make<Switching>},
    Kind{"greedy", "reads the ledger, lets it fill and spends it along the true motion", make<Greedy>},
    Kind{"replayed", "the forces of another run", make<Replayed>}};

const Kind& kind_of(const EnvironmentSetting& setting) {
  const auto found = std::ranges::find(kKinds, setting.name, &Kind::name);
  if (found != kKinds.end()) return *found;
  throw std::invalid_argument("unknown environment '" + setting.name + "'" +
                              text::suggestion(setting.name, environment_names()));
}

}  // namespace

Vector with_turn(const Vector& straight, const Vector& turn, double factor) {
  if (turn.rows() == 0) return straight;
  Vector both(straight.rows() + turn.rows());
  both << straight, factor * turn;
  return both;
}

std::vector<std::string> environment_names() {
  std::vector<std::string> names;
  names.reserve(kKinds.size());
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

std::string environments_help() {
  std::string text;
  for (const Kind& kind : kKinds) {
    text += "  " + std::string(kind.name) + std::string(20 - kind.name.size(), ' ') + std::string(kind.what) + "\n";
  }
  return text;
}

std::unique_ptr<server::Environment> make_environment(const EnvironmentSetting& setting,
                                                      std::unique_ptr<server::Environment> honest,
                                                      std::function<Truth()> truth) {
  auto adversary = kind_of(setting).make(setting);
  adversary->set_honest(std::move(honest), std::move(truth), setting.lever_m);
  return adversary;
}

server::EnvironmentKind taken_over(server::EnvironmentKind kind, const EnvironmentSetting& setting,
                                   std::function<Truth()> truth) {
  (void)kind_of(setting);
  kind.make = [honest = std::move(kind.make), setting, truth = std::move(truth)](const server::ClientFacts& client) {
    server::MadeEnvironment made = honest(client);
    made.environment = make_environment(setting, std::move(made.environment), truth);
    return made;
  };
  return kind;
}

}  // namespace forcebound::sim
