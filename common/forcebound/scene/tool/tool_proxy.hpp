#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/scene/plan_run.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/scene/tool/nearest_step.hpp"
#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/scene/tool/tool_edges.hpp"

namespace forcebound::scene {

/// The simulated pose of a tool, the god object of six degrees of freedom: it stays outside of what is solid while the
/// device's pose goes in, as near to that as it can. With v and w from the simulated pose to the next one, of the
/// tool's centre and about it, v_d and w_d to the device's, and rho the RMS distance of its points from the centre:
///
///     minimise |v - v_d|^2 + rho^2 |w - w_d|^2    so that    n_i . (v + w x r_i) + g_i >= 0
///
/// for every point and edge contact r_i with a gap of g_i and normal n_i there. Of objects that ToolEdges knows, its
/// contacts replace the points of the tool's convex parts. The multipliers l_i >= 0 are the depths by which the
/// points share what is missing:
///
///     sum l_i n_i = v - v_d,    sum r_i x l_i n_i = rho^2 (w - w_d)
///
/// so that points of stiffness k push like a spring k and k rho^2 between the two poses, however many there are. The
/// quasi-static step is that of Ortega, Redon, Coquillart, "A Six Degree-of-Freedom God-Object Method for Haptic
/// Display of Rigid Bodies with Surface Properties", TVCG 2007; here NearestStep finds it.
///
/// A motion goes in parts of at most kSlideMost_m while it touches, so that it passes no wall that is thicker.
///
/// Real time: noexcept, no allocation; at most kMovesMost parts, each with ToolEdges::find and NearestStep.
class ToolProxy {
 public:
  static constexpr double kSlideMost_m = 5e-4;

  /// States that edge contacts may have for each object, after those of the points; then one for all that find none.
  static constexpr std::uint32_t kEdgeStates = 63;

  /// What is near an object.
  struct Contact {
    double share_m = 0;            ///< l, 0: it does not touch
    SurfacePoint surface{};        ///< where the tool is simulated; its depth is at most rounding
    Point arm_m = Point::Zero();   ///< from the tool's centre to there, in the scene's axes
    Point slid_m = Point::Zero();  ///< goes on as the device's tool does where it touches
    bool acted = false;            ///< effects acted on the tick before
    double felt_share_m = 0;       ///< its share then
  };

  struct Near : Contact {
    std::uint32_t point = 0;
  };

  struct NearEdge : Contact {
    std::uint32_t key = 0;
    std::uint32_t state = kEdgeStates;  ///< of its own; kEdgeStates: none yet
    Point in_handle_m = Point::Zero();  ///< of the tool's surface there, from its tip in the handle's axes
  };

  ToolProxy(std::shared_ptr<const Tool> tool, const Scene& scene);

  /// As if the tool had never been anywhere. Its points' states are the caller's to forget.
  void begin_again() noexcept;

  /// Of a tool and plan with as many points and steps.
  void go_on_from(const ToolProxy& other) noexcept;

  /// Follows the device. @param from where it begins if it has not been anywhere, and something may be where the device
  /// is @param steps of the plan that are felt @param states of all points after each other
  void follow(const ToolPose& from, const ToolPose& device, const Plan& plan, std::span<const std::uint32_t> steps,
              std::span<std::byte> states) noexcept;

  /// Those of a solid step, ascending.
  [[nodiscard]] std::span<Near> near(std::size_t step) noexcept { return near_[step]; }

  [[nodiscard]] std::span<NearEdge> near_edges(std::size_t step) noexcept { return near_edges_[step]; }

  /// Gives an edge contact of a step a state; of too many, that of all, forgotten.
  void keep_state(NearEdge& edge, const Plan& plan, std::size_t step, std::span<std::byte> states) noexcept;

  [[nodiscard]] std::size_t state_of(const NearEdge& edge) const noexcept {
    return tool_->points().size() + edge.state;
  }

  [[nodiscard]] const ToolPose& pose() const noexcept { return pose_; }
  [[nodiscard]] Point centre_m() const noexcept { return pose_ * tool_->centre_m(); }

 private:
  static constexpr int kMovesMost = 8;

  /// Of the centre, and about it times rho [m].
  using Twist = NearestStep::Twist;

  struct Asked {
    const Plan& plan;
    std::span<const std::uint32_t> steps;
    std::span<std::byte> states;

    [[nodiscard]] PlanRun run_of(std::uint32_t point) const noexcept {
      return {plan, states.data() + point * plan.state_bytes()};
    }
  };

  [[nodiscard]] Twist twist_to(const ToolPose& device) const noexcept;
  /// No point of the tool moves further.
  [[nodiscard]] double length_m(const Twist& twist) const noexcept;
  void move(const Twist& twist) noexcept;
  [[nodiscard]] bool is_clear(const Asked& asked, const ToolPose& pose) noexcept;
  void find_near(const Asked& asked, double margin_m) noexcept;
  void find_near(const Asked& asked, std::uint32_t step, double margin_m) noexcept;
  void ask(const Asked& asked, double margin_m) noexcept;
  void ask_edges(const Asked& asked, std::uint32_t step, double margin_m) noexcept;
  void add_row(Contact& contact) noexcept;
  [[nodiscard]] Twist solve(const Twist& wanted) noexcept;

  std::shared_ptr<const Tool> tool_;
  ToolEdges edges_;
  std::vector<std::vector<Near>> near_;            // of each step, with room for all points
  std::vector<Near> next_;                         // likewise
  std::vector<std::uint32_t> tree_;                // likewise
  std::vector<std::vector<NearEdge>> near_edges_;  // of each step, with room for all contacts
  std::vector<NearEdge> next_edges_;               // likewise
  std::vector<EdgeContact> found_;                 // likewise
  std::vector<std::uint64_t> states_;              // of each step, one bit for each of kEdgeStates
  std::vector<NearestStep::Row> rows_;             // of all steps, of what can be met in a part of a motion
  std::vector<Contact*> of_rows_;
  NearestStep nearest_;
  double clear_m_ = 0;  // of the nearest point
  ToolPose pose_{};
  bool placed_ = false;
};

}  // namespace forcebound::scene
