#include "forcebound/tissue/deformed_surface.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "forcebound/tissue/triangle.hpp"

namespace forcebound::tissue {
namespace {

constexpr int kHopsMax = 16;  // of the place from triangle to triangle in one slide

// Of the square of a triangle's size: below that a place does not slide, since the triangle is a line.
constexpr double kFlatTriangle = 1e-12;

// Changes of the weights that leave a place inside its triangle, or on its edge; none for a corner.
using Slides = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2>;

Slides slides_of(const scene::Point& weight) noexcept {
  int least = 0;
  if (weight.minCoeff(&least) > 0) {
    Slides both(3, 2);
    both << -1, -1, 1, 0, 0, 1;
    return both;
  }
  if ((weight.array() > 0).count() < 2) return Slides(3, 0);
  Slides along(3, 1);
  along(least) = 0;
  along((least + 1) % 3) = 1;
  along((least + 2) % 3) = -1;
  return along;
}

// Change of the weights: D (D'X'X D)^-1 D' times the force on them.
scene::Point answer_of(const Slides& slides, const Eigen::Matrix3d& corners_m, const scene::Point& draw_m2) noexcept {
  if (slides.cols() == 1) {
    const scene::Point edge_m = corners_m * slides.col(0);
    const double square_m2 = edge_m.squaredNorm();
    if (!(square_m2 > 0)) return scene::Point::Zero();
    return slides.col(0) * (slides.col(0).dot(draw_m2) / square_m2);
  }
  if (slides.cols() == 0) return scene::Point::Zero();
  const Eigen::Matrix<double, 3, 2> edges_m = corners_m * slides;
  const Eigen::Matrix2d squares_m2 = edges_m.transpose() * edges_m;
  const double size_m2 = squares_m2.trace();
  if (!(squares_m2.determinant() > kFlatTriangle * size_m2 * size_m2)) return scene::Point::Zero();
  const Eigen::Vector2d draw = slides.transpose() * draw_m2;
  return slides * (squares_m2.inverse() * draw);
}

}  // namespace

Eigen::Index DeformedSurface::first_of(int triangle, int corner) const noexcept {
  return 3 * static_cast<Eigen::Index>(surface_.triangles()[triangle][corner]);
}

Eigen::Matrix3d DeformedSurface::corners_m(int triangle) const noexcept {
  Eigen::Matrix3d columns;
  for (int corner = 0; corner < 3; ++corner) {
    columns.col(corner) = surface_.corner_m(triangle, corner) + displacement_m_.segment<3>(first_of(triangle, corner));
  }
  return columns;
}

Eigen::Matrix3d DeformedSurface::corners_of(int triangle, const Eigen::VectorXd& all) const noexcept {
  Eigen::Matrix3d columns;
  for (int corner = 0; corner < 3; ++corner) columns.col(corner) = all.segment<3>(first_of(triangle, corner));
  return columns;
}

void DeformedSurface::add_to_corners(int triangle, const Eigen::Matrix3d& more, Eigen::VectorXd& all) const noexcept {
  for (int corner = 0; corner < 3; ++corner) all.segment<3>(first_of(triangle, corner)) += more.col(corner);
}

bool DeformedSurface::pulls(const SurfaceTie& tie) const noexcept {
  const Eigen::Matrix3d here_m = corners_m(tie.place.triangle);
  const scene::Point outward = (here_m.col(1) - here_m.col(0)).cross(here_m.col(2) - here_m.col(0));
  return (tie.probe_m - here_m * tie.place.weight).dot(outward) >= 0;
}

DeformedSurface::Slid DeformedSurface::slid(const SurfaceTie& tie) const noexcept {
  Slid best{tie.place, stretch_m(tie).squaredNorm()};
  for (int hop = 0; tie.slides && hop < kHopsMax; ++hop) {
    const PlacesAround around = surface_.places_around(best.place);
    const double before_m2 = best.square_m2;
    for (int k = 0; k < around.count; ++k) {
      const int triangle = around.place[k].triangle;
      const Eigen::Matrix3d here_m = corners_m(triangle);
      const scene::Point weight = nearest_weights(here_m.col(0), here_m.col(1), here_m.col(2), tie.probe_m);
      const double square_m2 = (tie.probe_m - here_m * weight).squaredNorm();
      if (square_m2 < best.square_m2) best = {{triangle, weight}, square_m2};
    }
    if (!(best.square_m2 < before_m2)) break;
  }
  return best;
}

void DeformedSurface::add_resistance(const SurfaceTie& tie, double stiffness_N_per_m, const Eigen::VectorXd& moved_m,
                                     Eigen::VectorXd& force_N) const noexcept {
  const Eigen::Matrix3d here_m = corners_m(tie.place.triangle);
  const Eigen::Matrix3d corners_moved_m = corners_of(tie.place.triangle, moved_m);
  const scene::Point place_moved_m = corners_moved_m * tie.place.weight;
  scene::Point weight_change = scene::Point::Zero();
  if (tie.slides) {
    const scene::Point draw_m2 = corners_moved_m.transpose() * tie.balanced_m - here_m.transpose() * place_moved_m;
    weight_change = answer_of(slides_of(tie.place.weight), here_m, draw_m2);
  }
  const scene::Point shortened_m = place_moved_m + here_m * weight_change;
  for (int corner = 0; corner < 3; ++corner) {
    force_N.segment<3>(first_of(tie.place.triangle, corner)) +=
        stiffness_N_per_m * (tie.place.weight[corner] * shortened_m - weight_change[corner] * tie.balanced_m);
  }
}

void DeformedSurface::add_at(const SurfacePlace& place, const scene::Point& force_N,
                             Eigen::VectorXd& all_N) const noexcept {
  add_to_corners(place.triangle, force_N * place.weight.transpose(), all_N);
}

}  // namespace forcebound::tissue
