#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/scene/plan_run.hpp"
#include "forcebound/scene/tool/tool.hpp"

namespace forcebound::scene {

/// The simulated pose of a tool, the god object of six degrees of freedom: it stays outside of what is solid while the
/// device's pose goes in, as near to that as it can. With v and w from the simulated pose to the next one, of the
/// tool's centre and about it, v_d and w_d to the device's, and rho the RMS distance of its points from the centre:
///
///     minimise |v - v_d|^2 + rho^2 |w - w_d|^2    so that    n_i . (v + w x r_i) + g_i >= 0
///
/// for every point r_i with a gap of g_i and normal n_i there. The multipliers l_i >= 0 are the depths by which the
/// points share what is missing:
///
///     sum l_i n_i = v - v_d,    sum r_i x l_i n_i = rho^2 (w - w_d)
///
/// so that points of stiffness k push like a spring k and k rho^2 between the two poses, however many there are. The
/// quasi-static step is that of Ortega, Redon, Coquillart, "A Six Degree-of-Freedom God-Object Method for Haptic
/// Display of Rigid Bodies with Surface Properties", TVCG 2007; here the multipliers are found by projected
/// Gauss-Seidel, which begins with those of the tick before.
///
/// A motion goes in parts of at most kSlideMost_m while it touches, so that it passes no wall that is thicker.
///
/// Real time: noexcept, no allocation; at most kMovesMost parts, kRoundsMost x kSweepsMost sweeps each.
class ToolProxy {
 public:
  static constexpr double kSlideMost_m = 5e-4;

  /// A point near an object.
  struct Near {
    std::uint32_t point = 0;
    double share_m = 0;           ///< l, 0: it does not touch
    SurfacePoint surface{};       ///< of the point where the tool is simulated; its depth is at most rounding
    Point arm_m = Point::Zero();  ///< from the tool's centre to the point, in the scene's axes
  };

  ToolProxy(std::shared_ptr<const Tool> tool, const Plan& plan);

  /// As if the tool had never been anywhere. Its points' states are the caller's to forget.
  void begin_again() noexcept;

  /// Of a tool and plan with as many points and steps.
  void go_on_from(const ToolProxy& other) noexcept;

  /// Follows the device. @param steps of the plan that are felt @param states of all points after each other
  void follow(const ToolPose& device, const Plan& plan, std::span<const std::uint32_t> steps,
              std::span<std::byte> states) noexcept;

  /// Those of a solid step, ascending.
  [[nodiscard]] std::span<const Near> near(std::size_t step) const noexcept { return near_[step]; }

  [[nodiscard]] const ToolPose& pose() const noexcept { return pose_; }
  [[nodiscard]] Point centre_m() const noexcept { return pose_ * tool_->centre_m(); }

 private:
  static constexpr int kMovesMost = 8;
  static constexpr int kRoundsMost = 6;
  static constexpr int kSweepsMost = 40;

  /// Of the centre, and about it times rho [m].
  using Twist = Eigen::Matrix<double, 6, 1>;

  struct Row {
    Twist direction;
    double gap_m;
    Near* near;
  };

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
  void find_near(const Asked& asked, double margin_m) noexcept;
  void find_near(const Asked& asked, std::uint32_t step, double margin_m) noexcept;
  void ask(const Asked& asked) noexcept;
  [[nodiscard]] Twist solve(const Twist& wanted) noexcept;
  [[nodiscard]] double sweep_working(Twist& step) const noexcept;

  std::shared_ptr<const Tool> tool_;
  std::vector<std::vector<Near>> near_;  // of each step, with room for all points
  std::vector<Near> next_;               // likewise
  std::vector<std::uint32_t> tree_;      // likewise
  std::vector<Row> rows_;                // of all steps, of what can be met in a part of a motion
  std::vector<const Row*> working_;
  double clear_m_ = 0;  // of the nearest point
  ToolPose pose_{};
  bool placed_ = false;
};

}  // namespace forcebound::scene
