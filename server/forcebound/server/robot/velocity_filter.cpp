#include "forcebound/server/robot/velocity_filter.hpp"

#include <cmath>

namespace forcebound::server {

const Vector& VelocityFilter::update(Nanoseconds now, const Vector& position) noexcept {
  if (!last_ || position.rows() != position_.rows()) {
    velocity_ = Vector::Zero(position.rows());
  } else {
    const double passed_s = time::to_seconds(now - *last_);
    if (!(passed_s > 0)) return velocity_;
    velocity_ -= std::expm1(-cutoff_rad_per_s_ * passed_s) * ((position - position_) / passed_s - velocity_);
  }
  position_ = position;
  last_ = now;
  return velocity_;
}

}  // namespace forcebound::server
