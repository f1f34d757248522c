// A stand-in for a ROS 2 node, on another implementation of DDS: publishes wrenches, and prints in JSON what it heard.
//
//     ros2_peer bus=fast|cyclone domain=N namespace=/NAME seconds=S publish=KIND [hz=N] [force=N] [type=NAME]
//               [frame=NAME] [stamp=now|1970|2100] [reliability=best-effort] [ownership=exclusive] [until-s=S]
//
// KIND: none; constant; spring, answering each pose; toggle, +force and -force each 50 ms, which measures how long one
// takes to be applied; nan; flood, as fast as it can. It publishes from when somebody subscribes, until-s seconds long,
// and ends after `seconds`.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/ros2/bus.hpp"

namespace forcebound::ros2_peer {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

std::int64_t wall_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

class Options {
 public:
  Options(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      const std::size_t at = word.find('=');
      if (at == std::string::npos) throw std::invalid_argument("KEY=VALUE expected, got '" + word + "'");
      values_[word.substr(0, at)] = word.substr(at + 1);
    }
  }
  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise) const {
    const auto found = values_.find(key);
    return found == values_.end() ? otherwise : found->second;
  }
  [[nodiscard]] double number(const std::string& key, double otherwise) const {
    const std::string found = text(key, "");
    return found.empty() ? otherwise : std::stod(found);
  }

 private:
  std::map<std::string, std::string> values_;
};

/// Microseconds, as median and 99 %.
nlohmann::json quantiles(std::vector<double> us) {
  if (us.empty()) return nullptr;
  std::ranges::sort(us);
  const auto at = [&](double share) {
    return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
  };
  return {{"p50", at(0.5)}, {"p99", at(0.99)}, {"count", us.size()}};
}

/// What it heard, and how long that took.
class Heard {
 public:
  void pose(const Pose& pose) {
    const std::scoped_lock lock(mutex_);
    out_us_.push_back(static_cast<double>(wall_ns() - pose.header.stamp_ns()) * 1e-3);
    if (poses_++ > 0) {
      for (std::size_t i = 0; i < 3; ++i) way_m_ += std::abs(pose.values[i] - pose_.values[i]);
    }
    pose_ = pose;
  }
  void twist(const Twist& twist) {
    const std::scoped_lock lock(mutex_);
    ++twists_;
    for (std::size_t i = 0; i < 3; ++i) fastest_m_per_s_ = std::max(fastest_m_per_s_, std::abs(twist.values[i]));
  }
  void wrench(const Wrench& wrench) {
    const std::scoped_lock lock(mutex_);
    ++wrenches_;
    force_N_ = wrench.values[0];
    largest_N_ = std::max(largest_N_, std::abs(force_N_));
    lowest_N_ = std::min(lowest_N_, force_N_);
    // Of a toggle: the first tick at which the new sign was applied.
    if (toggled_ns_ != 0 && force_N_ * toggled_to_N_ > 0) {
      in_us_.push_back(static_cast<double>(wrench.header.stamp_ns() - toggled_ns_) * 1e-3);
      toggled_ns_ = 0;
    }
  }
  void joints(const JointState& joints) {
    const std::scoped_lock lock(mutex_);
    ++joint_states_;
    joints_ = joints.name.size() == joints.position.size() ? joints.position.size() : 0;
  }
  void joy(const Joy& joy) {
    const std::scoped_lock lock(mutex_);
    ++joys_;
    pressed_ |= std::ranges::find(joy.buttons, 1) != joy.buttons.end();
  }
  void state(const OperatingState& state) {
    const std::scoped_lock lock(mutex_);
    states_.push_back(state.state);
  }
  void toggle(double to_N) {
    const std::scoped_lock lock(mutex_);
    toggled_to_N_ = to_N;
    toggled_ns_ = wall_ns();
  }
  [[nodiscard]] Pose newest_pose() const {
    const std::scoped_lock lock(mutex_);
    return pose_;
  }
  [[nodiscard]] nlohmann::json told() const {
    const std::scoped_lock lock(mutex_);
    return {{"poses", poses_},
            {"twists", twists_},
            {"wrenches", wrenches_},
            {"joint_states", joint_states_},
            {"joints", joints_},
            {"joys", joys_},
            {"pressed", pressed_},
            {"states", states_},
            {"frame", pose_.header.frame},
            {"way_m", way_m_},
            {"fastest_m_per_s", fastest_m_per_s_},
            {"force_N", force_N_},
            {"largest_N", largest_N_},
            {"lowest_N", lowest_N_},
            {"out_us", quantiles(out_us_)},
            {"in_us", quantiles(in_us_)}};
  }

 private:
  mutable std::mutex mutex_;
  Pose pose_{};
  std::uint64_t poses_ = 0, twists_ = 0, wrenches_ = 0, joint_states_ = 0, joys_ = 0;
  std::size_t joints_ = 0;
  bool pressed_ = false;
  std::vector<std::string> states_;
  double way_m_ = 0, fastest_m_per_s_ = 0, force_N_ = 0, largest_N_ = 0, lowest_N_ = 0, toggled_to_N_ = 0;
  std::int64_t toggled_ns_ = 0;
  std::vector<double> out_us_, in_us_;
};

class Peer {
 public:
  explicit Peer(const Options& options)
      : kind_(options.text("publish", "none")),
        hz_(options.number("hz", 1000)),
        force_N_(options.number("force", 0.5)),
        seconds_(options.number("seconds", 3)),
        until_s_(options.number("until-s", seconds_)),
        stamp_(options.text("stamp", "now")),
        frame_(options.text("frame", "")) {
    const Settings settings{.domain = static_cast<std::uint32_t>(options.number("domain", 0)),
                            .name_space = options.text("namespace", ""),
                            .type = options.text("type", Settings{}.type),
                            .best_effort = options.text("reliability", "reliable") == "best-effort",
                            .exclusive = options.text("ownership", "shared") == "exclusive"};
    const Ears ears{.pose = [this](const Pose& message) { hear(message); },
                    .twist = [this](const Twist& message) { heard_.twist(message); },
                    .wrench = [this](const Wrench& message) { heard_.wrench(message); },
                    .joints = [this](const JointState& message) { heard_.joints(message); },
                    .joy = [this](const Joy& message) { heard_.joy(message); },
                    .state = [this](const OperatingState& message) { heard_.state(message); }};
    const bool cyclone = options.text("bus", "fast") == "cyclone";
    bus_ = cyclone ? cyclone_bus(settings, ears) : fast_bus(settings, ears);
  }

  nlohmann::json run() {
    const auto patience = Steady::now() + std::chrono::duration<double>(seconds_);
    while (kind_ != "none" && !bus_->matched() && Steady::now() < patience) std::this_thread::sleep_for(5ms);
    const bool matched = bus_->matched();
    std::puts(matched ? "matched" : "not matched");
    std::fflush(stdout);
    const auto began = Steady::now();
    const auto passed = [&] { return std::chrono::duration<double>(Steady::now() - began).count(); };
    for (std::uint64_t i = 0; passed() < seconds_; ++i) {
      const bool publishes = passed() < until_s_;
      answers_ = publishes && kind_ == "spring";
      if (publishes) publish_next(passed());
      if (kind_ == "flood") continue;
      const std::chrono::duration<double> next_s(static_cast<double>(i) / hz_);
      std::this_thread::sleep_until(began + std::chrono::duration_cast<Steady::duration>(next_s));
    }
    answers_ = false;
    nlohmann::json told = heard_.told();
    told["matched"] = matched;
    told["published"] = published_.load();
    return told;
  }

 private:
  void hear(const Pose& pose) {
    heard_.pose(pose);
    if (!answers_) return;
    constexpr double kStiffness_N_per_m = 100;
    publish(-kStiffness_N_per_m * pose.values[0]);
  }

  void publish_next(double passed_s) {
    constexpr double kToggle_s = 0.05;
    if (kind_ == "constant" || kind_ == "flood") publish(force_N_);
    if (kind_ == "nan") publish(std::numeric_limits<double>::quiet_NaN());
    if (kind_ != "toggle") return;
    const double to_N = std::fmod(passed_s, 2 * kToggle_s) < kToggle_s ? force_N_ : -force_N_;
    if (to_N != toggled_to_N_) heard_.toggle(to_N);
    toggled_to_N_ = to_N;
    publish(to_N);
  }

  void publish(double x_N) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    constexpr std::int64_t k2100_s = 4'102'444'800 / 2;  // 32 bits of seconds end before
    const std::int64_t now = stamp_ == "1970" ? 0 : stamp_ == "2100" ? k2100_s * kSecond : wall_ns();
    bus_->publish({.header = {.sec = static_cast<std::int32_t>(now / kSecond),
                              .nanosec = static_cast<std::uint32_t>(now % kSecond),
                              .frame = frame_},
                   .values = {x_N}});
    ++published_;
  }

  std::string kind_;
  double hz_, force_N_, seconds_, until_s_;
  std::string stamp_, frame_;
  double toggled_to_N_ = 0;
  Heard heard_;
  std::atomic<bool> answers_{false};
  std::atomic<std::uint64_t> published_{0};
  std::unique_ptr<Bus> bus_;  // last: its threads use the rest
};

}  // namespace
}  // namespace forcebound::ros2_peer

int main(int argc, char** argv) {
  try {
    forcebound::ros2_peer::Peer peer{forcebound::ros2_peer::Options(argc, argv)};
    std::puts(peer.run().dump().c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ros2_peer: %s\n", error.what());
    return 1;
  }
}
