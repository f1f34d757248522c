#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::test {

/// A shape and the state of the one client that touches it.
class ShapeClient {
 public:
  explicit ShapeClient(std::unique_ptr<scene::Shape> shape)
      : shape_(std::move(shape)), state_((shape_->facts().state_bytes + sizeof(double) - 1) / sizeof(double)) {}

  scene::SurfacePoint at(const scene::Point& position_m) noexcept {
    return shape_->nearest(position_m, reinterpret_cast<std::byte*>(state_.data()));
  }

  void begin_again() noexcept { state_.assign(state_.size(), 0.0); }

  [[nodiscard]] const scene::Shape& shape() const noexcept { return *shape_; }

 private:
  std::unique_ptr<scene::Shape> shape_;
  std::vector<double> state_;
};

}  // namespace forcebound::test
