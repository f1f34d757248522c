#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/scene/plan_run.hpp"
#include "forcebound/scene/tool/tool_proxy.hpp"

namespace forcebound::scene {

/// What an object does to a tool.
struct ToolFelt {
  Reaction reaction{};               ///< the sum over its points
  Point torque_N_m = Point::Zero();  ///< about its tip, scene's axes
  SurfacePoint deepest{.penetration_m = 0};
  std::size_t contacts = 0;
};

/// The tool of one client, which touches objects with all of its points:
///
///     F = sum of f_i,   torque = sum of r_i x f_i,   f_i the effects on the point, r_i from the tip to it
///
/// so that the power is that of the points, sum f_i . v_i = F . v_tip + torque . w. The force of a point with a radius
/// acts at its middle: a ball rolls without feeling it. Every point has states of its own.
///
/// ToolContact::constraint: what is solid is touched as a body (ToolProxy). A point is as deep as its share, and has
/// that share of its speed along the normal: the tool is as stiff and as damped as one point. An edge contact moves
/// over the tool: its effects see a point that goes on as the tool does there. Where contacts take over from each
/// other, as those of a flat side do, one whose share doubles goes on with the states of the foremost one with its
/// normal. What pushes along the normal acts where the tool is simulated, so that it is the slope of an energy; what
/// acts along the surface, at the point whose way it is about.
///
/// ToolContact::penalty, and what is not solid: a point is as deep as where the device has it, and deeper by its
/// radius; more of them that touch are stiffer [penalty by points: McNeely et al., "Six Degree-of-Freedom Haptic
/// Rendering Using Voxel Sampling", SIGGRAPH 1999]. An object is asked about those points alone that the tree of the
/// tool does not show to be clear of it, by as much as the tool moved: so no point passes through a thin wall unseen. A
/// point that comes near begins outside, where it was before; one that leaves forgets what it felt. Those that touched
/// are asked again in any case.
///
/// Real time: noexcept, no allocation; O(points near the object) and Tool::find_near.
class ToolTouch {
 public:
  ToolTouch(std::shared_ptr<const Tool> tool, const Scene& scene);

  /// Plan::state_bytes are needed this many times.
  [[nodiscard]] static std::size_t states_of(const Tool& tool) noexcept {
    return tool.points().size() + (tool.contact() == ToolContact::constraint ? ToolProxy::kEdgeStates + 2 : 0);
  }

  /// All points are where they are now; what was felt before is the place before.
  void move(const ToolPose& pose) noexcept;

  /// What is solid is met there. Before it is felt. @param steps of the plan that are felt @param states as of `feel`
  void meet(const Plan& plan, std::span<const std::uint32_t> steps, std::span<std::byte> states) noexcept {
    if (proxy_) proxy_->follow(moved_ ? before_ : pose_, pose_, plan, steps, states);
  }

  /// Where the tool is simulated; null: where the device has it.
  [[nodiscard]] const ToolPose* simulated() const noexcept { return proxy_ ? &proxy_->pose() : nullptr; }

  /// As if the tool had never touched anything. Its points' states are the caller's to forget.
  /// @param free_m its tip where it was outside of everything solid, from where it comes to the next pose
  void begin_again(const Point& free_m) noexcept;

  /// Goes on as another one did, of a tool and plan with as many points and steps; else false, and nothing is done.
  [[nodiscard]] bool go_on_from(const ToolTouch& other) noexcept;

  /// @param number of the plan's step, an object @param at_tip its time and handle; its place is not used
  /// @param states of all points after each other, Plan::state_bytes each
  [[nodiscard]] ToolFelt feel(const Plan& plan, std::size_t number, const Probe& at_tip,
                              std::span<std::byte> states) noexcept;

 private:
  struct Visited {
    std::vector<std::uint32_t> points;    // ascending, with room for all
    std::vector<std::uint32_t> touching;  // of them
  };

  /// A point or edge contact, as its effects see it.
  struct Touching {
    Point in_handle_m;  // from the tip
    SurfacePoint surface{};
    Point arm_m = Point::Zero();  // from the tip to where it pushes
    Point seen_m = Point::Zero();
    double share = 1;  // of its speed along the normal
  };

  /// The contact of a solid step that had the most on the tick before: its states are kept after all others.
  struct Foremost {
    double share_m = 0;
    Point slid_m = Point::Zero();
    Point normal = Point::UnitX();
  };

  /// One call of feel_solid.
  struct Feeling {
    const Plan& plan;
    const PlanStep& step;
    const Probe& at_tip;
    std::span<std::byte> states;
    Foremost before;
    double together_m = 0;
    Foremost foremost{};
    std::size_t foremost_state = 0;
    ToolFelt felt{};
  };

  [[nodiscard]] ToolFelt feel_solid(const Plan& plan, std::size_t number, const Probe& at_tip,
                                    std::span<std::byte> states) noexcept;
  void feel_contact(Feeling& now, ToolProxy::Contact& one, const Point& in_handle_m, std::size_t state) const noexcept;
  void slide(const Feeling& now, ToolProxy::Contact& one, const Point& in_handle_m, std::size_t state) const noexcept;
  void copy_touching(const Feeling& now, std::size_t from, std::size_t to) const noexcept;
  [[nodiscard]] std::size_t state_of_foremost() const noexcept { return states_of(*tool_) - 1; }
  void find_near(const PlanStep& step, const Visited& before) noexcept;
  void add(const PlanStep& step, const Touching& touching, const PlanRun& run, Probe probe,
           ToolFelt& felt) const noexcept;

  std::shared_ptr<const Tool> tool_;
  std::optional<ToolProxy> proxy_;
  std::vector<Visited> visited_;     // of each step
  std::vector<Foremost> foremost_;   // likewise
  std::vector<std::uint32_t> tree_;  // room for all
  std::vector<std::uint32_t> near_;  // likewise
  ToolPose pose_{};
  ToolPose before_{};
  std::optional<Point> free_m_{};  // where it begins, if that was told
  bool placed_ = false;
  bool moved_ = false;  // there is a place before
};

}  // namespace forcebound::scene
