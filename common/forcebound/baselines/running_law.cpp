#include "forcebound/baselines/running_law.hpp"

#include <limits>
#include <utility>

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

const control::LawRegistry& laws() {
  static const control::LawRegistry kLaws = shipped_laws();
  return kLaws;
}

control::LawOptions complete(const std::string& name, const control::DeviceFacts& facts, control::LawOptions options) {
  options.parameters = laws().parameters(name, facts, options.parameters);
  return options;
}

}  // namespace

RunningLaw::RunningLaw(control::DeviceFacts facts, const std::string& name, control::LawOptions options)
    : facts_(std::move(facts)),
      options_(complete(name, facts_, std::move(options))),
      bounder_(facts_, laws().make(name, facts_, options_)),
      damping_(control::Damping::from_matrix(facts_.damping)) {
  motion_.position = Vector::Zero(facts_.degrees_of_freedom());
  motion_.joint = Vector::Zero(facts_.joints());
  motion_.jacobian = Matrix::Identity(facts_.degrees_of_freedom(), facts_.joints());
  motion_.damping = &damping_;
  time_by_facts();
}

void RunningLaw::time_by_facts() noexcept {
  motion_.latency_s = motion_.latency_s_max = facts_.latency_s;
  motion_.effect_s = std::numeric_limits<double>::quiet_NaN();
  motion_.held_s = std::numeric_limits<double>::infinity();
  motion_.write_failed = false;
}

void RunningLaw::begin_tick() noexcept {
  begun_ = true;
  if (facts_.cartesian) {
    motion_.joint = motion_.position;
  } else {
    damping_ = control::Damping::from_joints(motion_.jacobian, facts_.damping);
  }
}

Vector RunningLaw::tick(const Vector& request_N) noexcept {
  begin_tick();
  return bounder_.tick(motion_, request_N);
}

Vector RunningLaw::release() noexcept {
  begin_tick();
  return bounder_.release(motion_);
}

}  // namespace forcebound::baselines
