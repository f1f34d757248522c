#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/scene/plan.hpp"
#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/scene/tool/tool_part.hpp"

namespace forcebound::scene {

/// Where a tool and an object are near to each other.
struct EdgeContact {
  std::uint32_t key = 0;          ///< which edge, and which end of it: the same from pose to pose
  Point at_m = Point::Zero();     ///< of the tool, in the scene's frame
  Point normal = Point::UnitX();  ///< unit, out of the object
  double gap_m = 0;
};

/// What a tool's points leave out: the edges of its convex parts and of objects that are boxes, balls, rods or planes.
/// An edge of one is asked about the other,
///
///     gap(t) = distance of edge(t) from the solid,  least over t
///
/// which is convex in t on a line, so that the least is found by tangents and halving, to 1e-11 m; on a circle, by
/// halving beside the least of its samples. Where an edge lies along a face, both ends of what is over the face count:
/// between them nothing is nearer. So the contacts of two such solids hold them apart everywhere, however far apart the
/// tool's points are.
///
/// Parts are rounded by kRounded_m, so that edges that touch have a direction.
///
/// Real time: `find` is noexcept, allocates nothing; O(edges), of those that are near at most 80 distances each.
class ToolEdges {
 public:
  static constexpr double kRounded_m = 5e-7;

  /// @param objects must outlive this
  ToolEdges(const Tool& tool, std::span<const SceneObject> objects);

  /// Whether an object has contacts; else it is the points' alone.
  [[nodiscard]] bool knows(std::size_t object) const noexcept { return !parts_.empty() && has_normals(object); }
  /// Whether the distance of an object has a normal on its surface, too: else points keep kRounded_m away from it.
  [[nodiscard]] bool has_normals(std::size_t object) const noexcept { return objects_[object].solid != Solid::other; }
  /// No more contacts at once are told of any object.
  [[nodiscard]] std::size_t contacts_most() const noexcept { return most_; }

  /// Appends all contacts with a gap below `margin_m`, by ascending key.
  /// @param flat_m ends of what lies along a face are told of contacts nearer than that @param found has room
  void find(std::size_t object, const ToolPose& pose, double margin_m, double flat_m,
            std::vector<EdgeContact>& found) const noexcept;

 private:
  /// Of the tool in the handle's frame; of objects, in the scene's.
  struct Part {
    std::unique_ptr<Shape> core{};
    Point middle_m = Point::Zero();
    double reach_m = 0;    // from there
    double rounded_m = 0;  // the part is as much larger than its core
    ToolPart::Kind kind{};
    SolidEdges edges{};
  };

  enum class Solid : std::uint8_t { other, half_space, box, round, cylinder };

  struct Object {
    const Shape* shape = nullptr;
    Solid solid = Solid::other;
    SolidEdges edges{};
  };

  [[nodiscard]] static Part part_of(const ToolPart& part);
  [[nodiscard]] static Object object_of(const SceneObject& object);
  /// Calls with each edge of the one that is asked about the other, and its number.
  template <class Use>
  static void for_edges_of_tool(const Part& part, const Object& object, Use use);
  template <class Use>
  static void for_edges_of_object(const Part& part, const Object& object, Use use);

  std::vector<Part> parts_;
  std::vector<Object> objects_;
  std::size_t most_ = 0;
};

}  // namespace forcebound::scene
