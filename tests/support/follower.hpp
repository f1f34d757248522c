#pragma once

#include <memory>

#include "forcebound/scene/geometry/god_object.hpp"
#include "tests/support/meshes.hpp"

namespace forcebound::test {

/// A god object on a mesh, for one client.
class Follower {
 public:
  explicit Follower(scene::TriangleMesh mesh, const scene::GodObjectOptions& options = {})
      : object_(std::make_shared<const scene::TriangleMesh>(std::move(mesh)), options) {}
  explicit Follower(const Soup& soup, const scene::GodObjectOptions& options = {}) : Follower(soup.mesh(), options) {}

  scene::SurfacePoint to(const Point& goal_m) noexcept { return object_.follow(goal_m, state_); }

  /// Where the god object is, in the scene's frame.
  [[nodiscard]] Point at_m() const {
    return Point(state_.x_m, state_.y_m, state_.z_m) + object_.bvh().mesh().origin_m();
  }

  [[nodiscard]] const scene::GodObject& object() const noexcept { return object_; }
  [[nodiscard]] const scene::Proxy& state() const noexcept { return state_; }

 private:
  scene::GodObject object_;
  scene::Proxy state_{};
};

/// Force of a spring of 1 N/m.
inline Point spring_force(const scene::SurfacePoint& found) { return found.penetration_m * found.normal; }

}  // namespace forcebound::test
