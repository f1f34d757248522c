#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <array>
#include <cmath>
#include <limits>

#include "forcebound/scene/geometry/bvh.hpp"

namespace forcebound::test {

/// A mesh in Embree, in single precision: an independent reference for the queries of Bvh.
class EmbreeScene {
 public:
  explicit EmbreeScene(const scene::TriangleMesh& mesh) : mesh_(mesh) {
    const auto geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices_m().size()));
    for (const auto& vertex : mesh.vertices_m()) {
      for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(vertex[axis]);
    }
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles().size()));
    for (const auto& triangle : mesh.triangles()) {
      for (const unsigned corner : triangle) *corners++ = corner;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Embree finds the boxes; the nearest point of a triangle is computed by our function, since Embree has none.
  [[nodiscard]] double nearest_distance_m(const scene::Point& point_m) const {
    Query query{mesh_, point_m, std::numeric_limits<double>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    const auto at = single(point_m);
    RTCPointQuery asked{at[0], at[1], at[2], 0, std::numeric_limits<float>::infinity()};
    rtcPointQuery(scene_, &asked, &context, look_at, &query);
    return query.distance_m;
  }

 private:
  struct Query {
    const scene::TriangleMesh& mesh;
    scene::Point point_m;
    double distance_m;
  };

  static std::array<float, 3> single(const scene::Point& p) {
    return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
  }

  static bool look_at(RTCPointQueryFunctionArguments* arguments) {
    auto& query = *static_cast<Query*>(arguments->userPtr);
    const auto corner = [&](std::size_t i) -> const scene::Point& { return query.mesh.corner_m(arguments->primID, i); };
    const auto on = scene::nearest_on_triangle(query.point_m, corner(0), corner(1), corner(2));
    const double distance_m = (on.point_m - query.point_m).norm();
    if (distance_m >= query.distance_m) return false;
    query.distance_m = distance_m;
    arguments->query->radius = static_cast<float>(distance_m);
    return true;
  }

  const scene::TriangleMesh& mesh_;
  RTCDevice device_ = rtcNewDevice("threads=1");
  RTCScene scene_ = rtcNewScene(device_);
};

}  // namespace forcebound::test
