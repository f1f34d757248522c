#include "forcebound/server/follower/follower_environment.hpp"

#include <algorithm>
#include <stdexcept>

namespace forcebound::server {
namespace {

class FollowerEnvironment;

/// Which leader has the robot; shared by all sessions that ask for it.
struct Seat {
  const FollowerEnvironment* holder = nullptr;
  std::shared_ptr<const std::string> leader{};  ///< the holder's name
};

class FollowerEnvironment final : public Environment {
 public:
  FollowerEnvironment(std::shared_ptr<FollowerRunner> runner, std::shared_ptr<const FollowerAppearance> appearance,
                      std::shared_ptr<Seat> seat, std::string leader, bool shows_torque)
      : runner_(std::move(runner)),
        appearance_(std::move(appearance)),
        seat_(std::move(seat)),
        leader_(std::make_shared<const std::string>(std::move(leader))),
        shows_torque_(shows_torque) {
    occupy_seat();
  }
  ~FollowerEnvironment() override {
    if (seat_->holder != this) return;
    runner_->leave();
    *seat_ = {};
  }
  FollowerEnvironment(const FollowerEnvironment&) = delete;
  FollowerEnvironment& operator=(const FollowerEnvironment&) = delete;

  [[nodiscard]] Answer respond(const Motion& motion) noexcept override {
    const Eigen::Index rows = motion.position.rows();
    if (seat_->holder == nullptr) occupy_seat();
    // Another leader took the robot while this one was silent.
    if (seat_->holder != this) return {.force = Vector::Zero(rows), .follower = control::FollowerState::taken};
    const LeaderMotion leader{.position = motion.position,
                              .handle = motion.handle,
                              .energy_given_J = motion.energy_given_J,
                              .arrived = motion.server_time};
    const FollowerReport& report = runner_->exchange(leader);
    const ToolPose wanted = report.map.tool_of(leader);
    const Eigen::Vector3d& wanted_m = wanted.position;
    const Eigen::Vector3d force_N = report.share * report.map.to_leader_N(report.reflection.at(wanted_m));
    Answer answer{.force = force_N.head(std::min<Eigen::Index>(rows, 3)), .follower = report.state};
    if (shows_torque_ && motion.handle.orientation && report.reflection.torque_N_m_max > 0) {
      answer.torque_N_m = report.share * report.map.to_leader_N_m(report.reflection.torque_at(wanted.orientation));
    }
    if (report.reflection.plane && report.share > 0) add_plane(report, wanted_m, rows, answer);
    return answer;
  }

  /// Of the whole world: nothing of it is handed over.
  [[nodiscard]] std::shared_ptr<const view::Description> appearance(view::Which /*which*/) override {
    return appearance_ ? appearance_->description() : nullptr;
  }

  [[nodiscard]] std::size_t sample(std::size_t group, std::size_t first, std::span<float> to) const noexcept override {
    return appearance_ ? appearance_->sample(runner_->newest(), group, first, to) : 0;
  }

 private:
  void occupy_seat() noexcept {
    *seat_ = {.holder = this, .leader = leader_};
    runner_->begin_leader();
  }

  static void add_plane(const FollowerReport& report, const Eigen::Vector3d& wanted_m, Eigen::Index rows,
                        Answer& answer) noexcept {
    const ReflectedPlane& plane = *report.reflection.plane;
    const Eigen::Vector3d normal = report.map.to_leader_direction(plane.normal);
    const double depth_m = (plane.place_m - wanted_m).dot(plane.normal);
    if (depth_m > 0) {
      answer.contact_normal = normal.head(rows);
      answer.penetration_m = depth_m / report.map.settings().motion_scale;
    }
    if (report.share < 1) return;  // the force alone, while it begins
    const double stiffness = report.map.leader_stiffness_N_per_m(plane.stiffness_N_per_m);
    local_model::Surface& surface = answer.model.surfaces[0];
    surface.id = plane.id;
    surface.normal = normal;
    surface.place_m = report.map.leader_place_m(plane.place_m);
    surface.stiffness_N_per_m = stiffness * normal * normal.transpose();
    surface.friction = plane.friction;
    surface.force_N = Eigen::Vector3d::Zero();
    surface.force_N.head(rows) = answer.force;
    constexpr double kReach_m = 1;  // a plane, as far as a hand's workspace goes
    surface.radius_m = kReach_m;
    answer.model.surface_count = 1;
  }

  std::shared_ptr<FollowerRunner> runner_;
  std::shared_ptr<const FollowerAppearance> appearance_;
  std::shared_ptr<Seat> seat_;
  std::shared_ptr<const std::string> leader_;
  bool shows_torque_;
};

}  // namespace

StepwiseRunner::StepwiseRunner(std::shared_ptr<Follower> follower, Nanoseconds now)
    : follower_(std::move(follower)), next_(now) {
  follower_->start();
}

const FollowerReport& StepwiseRunner::exchange(const LeaderMotion& motion) noexcept {
  live_until(motion.arrived);
  follower_->receive(motion);
  return follower_->report();
}

void StepwiseRunner::live_until(Nanoseconds time) noexcept {
  for (; next_ <= time; next_ += follower_->period()) follower_->tick(next_);
}

EnvironmentKind follower_environment(std::string name, std::string simulated, int degrees_of_freedom,
                                     std::shared_ptr<FollowerRunner> runner,
                                     std::shared_ptr<const FollowerAppearance> appearance) {
  EnvironmentKind kind;
  kind.name = std::move(name);
  for (int rows = degrees_of_freedom; rows <= 3; ++rows) {
    kind.degrees_of_freedom.push_back(static_cast<std::uint32_t>(rows));
  }
  kind.make = [seat = std::make_shared<Seat>(), runner = std::move(runner), appearance = std::move(appearance),
               simulated = std::move(simulated)](const ClientFacts& client) {
    if (seat->holder != nullptr && !runner->newest().leader_lost) {
      throw std::runtime_error("the robot is led by '" + *seat->leader + "': it follows one leader at a time");
    }
    const std::string leader = client.device.empty() ? "a device without a name" : client.device;
    return MadeEnvironment{
        .environment = std::make_unique<FollowerEnvironment>(runner, appearance, seat, leader, client.shows_torque),
        .simulated = simulated,
        .least_rendering = scene::Rendering::modelled,
        .takes_energy = true};
  };
  return kind;
}

}  // namespace forcebound::server
