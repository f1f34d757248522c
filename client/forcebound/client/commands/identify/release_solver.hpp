#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "forcebound/client/commands/identify/release_state.hpp"
#include "forcebound/client/commands/identify/slide.hpp"
#include "forcebound/client/commands/identify/slide_motion.hpp"

namespace forcebound::client::commands::identify {

// Shared by all slides of a joint.
inline constexpr int kMobility = 0;  // 1 / mass
inline constexpr int kSlowingForward = 1;
inline constexpr int kSlowingBackward = 2;
inline constexpr int kRate = 3;  // damping / mass
inline constexpr int kLatency = 4;
inline constexpr int kLetGo = 5;  // from the last command before silence to the end of its force
inline constexpr int kSharedCount = 6;
using SharedVector = Eigen::Matrix<double, kSharedCount, 1>;
using SharedMatrix = Eigen::Matrix<double, kSharedCount, kSharedCount>;

/// Where a slide's used samples begin.
struct Point {
  double progress = 0;
  double speed = 0;
};

/// The fit of ReleaseFit from a beginning to the nearest best place.
class ReleaseSolver {
 public:
  ReleaseSolver(std::span<const Slide> slides, double step) : slides_(slides), step_(step) {
    for (const Slide& slide : slides) parts_.push_back(part_of(slide));
    points_.resize(slides.size());
  }

  [[nodiscard]] int usable(Slide::End end) const noexcept {
    int count = 0;
    for (std::size_t i = 0; i < slides_.size(); ++i) count += used(i) && slides_[i].end == end;
    return count;
  }

  void begin_at(const SharedVector& shared) noexcept {
    shared_ = shared;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
      if (used(i)) begin_slide(i);
    }
  }

  /// Levenberg-Marquardt. @returns whether it came to rest
  bool run(bool with_silence);

  [[nodiscard]] double cost() const noexcept { return cost_at(shared_, points_); }
  [[nodiscard]] const SharedVector& shared() const noexcept { return shared_; }
  [[nodiscard]] ReleaseState at_release(std::size_t slide) const noexcept;
  [[nodiscard]] bool used(std::size_t slide) const noexcept { return parts_[slide].end > parts_[slide].begin; }
  struct Errors {
    SharedMatrix by_scatter = SharedMatrix::Zero();
    SharedMatrix by_rounding = SharedMatrix::Zero();
    SharedVector telling = SharedVector::Zero();  ///< slides that tell of each, as if all told as much
  };
  [[nodiscard]] Errors errors(bool with_silence) const noexcept;
  [[nodiscard]] double residual_steps() const noexcept;

 private:
  struct Normal {  // of one slide, its own two unknowns eliminated
    SharedMatrix matrix = SharedMatrix::Zero();
    SharedVector score = SharedVector::Zero();
    Eigen::Matrix<double, kSharedCount, 2> cross = Eigen::Matrix<double, kSharedCount, 2>::Zero();
    Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
    Eigen::Vector2d own_score = Eigen::Vector2d::Zero();
  };

  [[nodiscard]] double way(std::size_t slide, double time_s, double after_s, const SharedVector& shared,
                           const Point& point) const noexcept;
  [[nodiscard]] double weight(std::size_t slide, std::size_t sample) const noexcept;
  [[nodiscard]] Normal normal(std::size_t slide, double lambda) const noexcept;
  [[nodiscard]] double cost_at(const SharedVector& shared, const std::vector<Point>& points) const noexcept;
  void begin_slide(std::size_t slide) noexcept;
  static void freeze_unused(SharedMatrix& matrix, bool with_silence) noexcept;

  [[nodiscard]] double slowing(std::size_t slide, const SharedVector& shared) const noexcept {
    return shared[slides_[slide].direction > 0 ? kSlowingForward : kSlowingBackward];
  }
  [[nodiscard]] double begin_s(std::size_t slide) const noexcept {
    return slides_[slide].samples[parts_[slide].begin].latched_s;
  }
  /// From the beginning to the end of the push.
  [[nodiscard]] double pushed_s(std::size_t slide, const SharedVector& shared) const noexcept {
    const bool silent = slides_[slide].end == Slide::End::silence;
    return slides_[slide].released_s() + shared[silent ? kLetGo : kLatency] - begin_s(slide);
  }
  /// From the beginning until friction has stopped it.
  [[nodiscard]] double moving_s(std::size_t slide, const SharedVector& shared, const Point& point) const noexcept;

  std::span<const Slide> slides_;
  double step_;
  std::vector<Part> parts_;
  SharedVector shared_ = SharedVector::Zero();
  std::vector<Point> points_;
};

}  // namespace forcebound::client::commands::identify
