#pragma once

#include <memory>

#include "forcebound/server/geometry/god_object.hpp"
#include "tests/support/meshes.hpp"

namespace forcebound::test {

/// A god object on a mesh, and the one client that moves it.
class Follower {
 public:
  explicit Follower(server::TriangleMesh mesh, const server::GodObjectOptions& options = {})
      : object_(std::make_shared<const server::TriangleMesh>(std::move(mesh)), options) {}
  explicit Follower(const Soup& soup, const server::GodObjectOptions& options = {}) : Follower(soup.mesh(), options) {}

  server::SurfacePoint to(const Point& goal_m) noexcept { return object_.follow(goal_m, state_); }

  /// Where the god object is, in the scene's frame.
  [[nodiscard]] Point at_m() const {
    return Point(state_.x_m, state_.y_m, state_.z_m) + object_.bvh().mesh().origin_m();
  }

  [[nodiscard]] const server::GodObject& object() const noexcept { return object_; }
  [[nodiscard]] const server::Proxy& state() const noexcept { return state_; }

 private:
  server::GodObject object_;
  server::Proxy state_{};
};

/// What a spring of 1 N/m would push with.
inline Point spring_force(const server::SurfacePoint& found) { return found.penetration_m * found.normal; }

}  // namespace forcebound::test
