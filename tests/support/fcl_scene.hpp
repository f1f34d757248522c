#pragma once

#include <fcl/fcl.h>

#include <memory>
#include <vector>

#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::test {

/// A mesh in the Flexible Collision Library: an independent reference for distances.
class FclScene {
 public:
  explicit FclScene(const scene::TriangleMesh& mesh) {
    std::vector<fcl::Triangle> triangles;
    for (const auto& triangle : mesh.triangles()) triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    tree_->beginModel();
    tree_->addSubModel(std::vector<fcl::Vector3d>(mesh.vertices_m().begin(), mesh.vertices_m().end()), triangles);
    tree_->endModel();
    tree_->computeLocalAABB();
  }

  /// To the surface, from outside or inside. FCL has no points, so a ball of radius zero is used.
  [[nodiscard]] double nearest_distance_m(const scene::Point& point_m) const {
    fcl::Transform3d there = fcl::Transform3d::Identity();
    there.translation() = point_m;
    fcl::DistanceResultd result;
    return fcl::distance<double>(tree_.get(), fcl::Transform3d::Identity(), &ball_, there, fcl::DistanceRequestd(true),
                                 result);
  }

 private:
  std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> tree_ = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  fcl::Sphered ball_{1e-12};
};

}  // namespace forcebound::test
