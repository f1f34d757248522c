#include <forcebound/server/follower/follower.hpp>
#include <forcebound/server/robot/driver_robot.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <utility>

namespace {

using namespace std::chrono_literals;

class SetClock final : public forcebound::time::Clock {
 public:
  [[nodiscard]] forcebound::time::Nanoseconds now() const noexcept override { return time; }
  forcebound::time::Nanoseconds time{1s};
};

}  // namespace

/// A hand keeps still for 1 s, goes 30 mm up within 1 s and keeps still again.
int main() try {
  SetClock clock;
  auto robot = forcebound::server::open_robot(ARM_FILE);
  std::printf("%s\n", robot->facts_in_words().c_str());
  forcebound::server::Follower follower(std::move(robot), {.architecture = "position-position"},
                                        forcebound::control::force_bounding_laws(), clock);
  follower.start();
  forcebound::server::LeaderMotion leader;
  leader.position = forcebound::control::Vector::Zero(3);
  double before_m = 0;
  for (int tick = 0; tick < 4000; ++tick, clock.time += 1ms) {
    follower.tick(clock.time);
    if (tick == 1000) before_m = follower.report().picture.tool.position.z();
    leader.position[2] = 0.03 * std::clamp(1e-3 * tick - 1, 0.0, 1.0);
    leader.arrived = clock.time;
    leader.energy_given_J += 2e-3;
    follower.receive(leader);
  }
  const double moved_m = follower.report().picture.tool.position.z() - before_m;
  follower.stop(clock.time);
  std::printf("its tool went %.1f mm up\n", 1e3 * moved_m);
  return moved_m > 0.027 && moved_m < 0.031 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "lead_the_arm: %s\n", error.what());
  return 1;
}
