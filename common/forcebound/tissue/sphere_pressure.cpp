#include "forcebound/tissue/sphere_pressure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/tissue/sphere_depth.hpp"

namespace forcebound::tissue {
namespace {

// Size of a triangle's parts, as a share of the sphere's radius.
constexpr double kAcross = 0.25;

// Share of the skin beyond which a sphere does not go by itself.
constexpr double kDeepest = 0.75;

// Share of the skin beyond which no pressure is computed: there it is unbounded.
constexpr double kPressedMost = 0.99;

// The skin's energy, pressure and stiffness at a depth, per area.
struct Skin {
  double stiffness_Pa_per_m;
  double thickness_m;

  [[nodiscard]] double energy_J_per_m2(double depth_m) const noexcept {
    const double left = 1 - depth_m / thickness_m;
    if (!(left > 0)) return std::numeric_limits<double>::infinity();
    return 0.5 * stiffness_Pa_per_m * depth_m * depth_m / left;
  }
  [[nodiscard]] double pressure_Pa(double depth_m) const noexcept {
    const double share = std::min(depth_m / thickness_m, kPressedMost);
    return stiffness_Pa_per_m * depth_m * (1 - 0.5 * share) / ((1 - share) * (1 - share));
  }
  [[nodiscard]] double steepness_Pa_per_m(double depth_m) const noexcept {
    const double left = 1 - std::min(depth_m / thickness_m, kPressedMost);
    return stiffness_Pa_per_m / (left * left * left);
  }
};

struct Size {
  double across_m;
  double area_m2;
};

std::vector<Size> sizes_of(const TissueSurface& surface) {
  std::vector<Size> sizes;
  sizes.reserve(surface.triangles().size());
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    const scene::Point ab = surface.corner_m(t, 1) - surface.corner_m(t, 0);
    const scene::Point ac = surface.corner_m(t, 2) - surface.corner_m(t, 0);
    sizes.push_back(
        {.across_m = std::max({ab.norm(), ac.norm(), (ac - ab).norm()}), .area_m2 = 0.5 * ab.cross(ac).norm()});
  }
  return sizes;
}

double divisions_for(const Size& size, double radius_m) { return std::ceil(size.across_m / (kAcross * radius_m)); }

// Infinite where a triangle would have to be cut too often.
double places_for(const std::vector<Size>& sizes, double radius_m) {
  double places = 0;
  for (const Size& size : sizes) {
    const double divisions = divisions_for(size, radius_m);
    if (divisions > SpherePressure::kDivisionsMax) return std::numeric_limits<double>::infinity();
    places += divisions * divisions;
  }
  return places;
}

[[noreturn]] void refuse(const std::vector<Size>& sizes, double radius_m, const std::string& name) {
  constexpr double kWider = 1.02;       // at each try
  constexpr double kRoundedUp = 1.005;  // three digits are off by half a percent at most
  const double longest_m = std::ranges::max(sizes, {}, &Size::across_m).across_m;
  double enough_m = std::max(radius_m, longest_m / (kAcross * SpherePressure::kDivisionsMax));
  while (places_for(sizes, enough_m) > SpherePressure::kPlacesMax) enough_m *= kWider;
  throw std::runtime_error(name + ": a sphere of radius " + text::to_text(radius_m) +
                           " m is too small beside edges of " + text::rounded(longest_m) + " m on a surface of " +
                           std::to_string(sizes.size()) + " triangles: expected 0 (a point), or at least " +
                           text::rounded(kRoundedUp * enough_m) + " m");
}

// The corners' weights at the centroids of n^2 equal parts of a triangle, those that point as it does and the others.
template <typename Do>
void for_each_centroid(int divisions, const Do& act) noexcept {
  const double part = 1.0 / divisions;
  const auto at = [&](double on_b, double on_c) {
    act(scene::Point(1 - (on_b + on_c) * part, on_b * part, on_c * part));
  };
  for (int b = 0; b < divisions; ++b) {
    for (int c = 0; b + c < divisions; ++c) {
      at(b + 1.0 / 3, c + 1.0 / 3);
      if (b + c + 1 < divisions) at(b + 2.0 / 3, c + 2.0 / 3);
    }
  }
}

// Whether any part of a triangle may be within a distance of a segment.
bool is_near(const Eigen::Matrix3d& corners_m, const scene::Point& from_m, const scene::Point& way_m,
             double reach_m) noexcept {
  const scene::Point middle_m = corners_m.rowwise().mean();
  const double size_m = std::sqrt((corners_m.colwise() - middle_m).colwise().squaredNorm().maxCoeff());
  const scene::Point to_middle_m = middle_m - from_m;
  const double square_m2 = way_m.squaredNorm();
  const double along = square_m2 > 0 ? std::clamp(to_middle_m.dot(way_m) / square_m2, 0.0, 1.0) : 0;
  return (to_middle_m - along * way_m).squaredNorm() < (reach_m + size_m) * (reach_m + size_m);
}

// A place that pushes.
struct PushedPlace {
  scene::Point weight;
  scene::Point outward;  // unit, from the sphere's centre to it
  double away_m;         // from the centre
  double depth_m;
};

template <typename Do>
void for_each_pushed(const Eigen::Matrix3d& corners_m, int divisions, const scene::Point& center_m, double radius_m,
                     const Do& act) noexcept {
  const Eigen::Matrix3d from_center_m = corners_m.colwise() - center_m;
  for_each_centroid(divisions, [&](const scene::Point& weight) {
    const scene::Point away = from_center_m * weight;
    const double square_m2 = away.squaredNorm();
    if (!(square_m2 < radius_m * radius_m)) return;
    const double away_m = std::max(std::sqrt(square_m2), std::numeric_limits<double>::min());
    act(PushedPlace{.weight = weight, .outward = away / away_m, .away_m = away_m, .depth_m = radius_m - away_m});
  });
}

}  // namespace

void PressedTriangles::clear() noexcept {
  for (std::size_t n = 0; n < count; ++n) resistance[touched[n]].setZero();
  count = 0;
}

void PressedTriangles::add(int triangle, const Resistance& more) noexcept {
  // A pushed triangle has a resistance: one without has not been touched yet.
  if (resistance[triangle].isZero(0)) touched[count++] = triangle;
  resistance[triangle] += more;
}

SpherePressure::SpherePressure(const TissueSurface& surface, double radius_m, double stiffness_Pa_per_m,
                               const std::string& name)
    : radius_m_(radius_m), stiffness_Pa_per_m_(stiffness_Pa_per_m) {
  const std::vector<Size> sizes = sizes_of(surface);
  const double places = places_for(sizes, radius_m);
  if (!(places <= kPlacesMax)) refuse(sizes, radius_m, name);
  places_ = static_cast<std::size_t>(places);
  cuts_.reserve(sizes.size());
  for (const Size& size : sizes) {
    const double divisions = divisions_for(size, radius_m);
    cuts_.push_back({.divisions = static_cast<int>(divisions), .area_m2 = size.area_m2 / (divisions * divisions)});
  }
}

template <typename Do>
void SpherePressure::for_each_near(const DeformedSurface& surface, const scene::Point& center_m,
                                   const Do& act) const noexcept {
  for (int triangle = 0; triangle < static_cast<int>(cuts_.size()); ++triangle) {
    const Eigen::Matrix3d corners_m = surface.corners_m(triangle);
    if (is_near(corners_m, center_m, scene::Point::Zero(), radius_m_)) act(triangle, corners_m, cuts_[triangle]);
  }
}

double SpherePressure::energy_J(const DeformedSurface& surface, const scene::Point& center_m) const noexcept {
  const Skin skin{stiffness_Pa_per_m_, skin_m()};
  double energy_J = 0;
  for_each_near(surface, center_m, [&](int /*triangle*/, const Eigen::Matrix3d& corners_m, const Cut& cut) {
    for_each_pushed(corners_m, cut.divisions, center_m, radius_m_,
                    [&](const PushedPlace& place) { energy_J += cut.area_m2 * skin.energy_J_per_m2(place.depth_m); });
  });
  return energy_J;
}

void SpherePressure::add_forces(const DeformedSurface& surface, const scene::Point& center_m,
                                Eigen::VectorXd& on_nodes_N) const noexcept {
  const Skin skin{stiffness_Pa_per_m_, skin_m()};
  for_each_near(surface, center_m, [&](int triangle, const Eigen::Matrix3d& corners_m, const Cut& cut) {
    Eigen::Matrix3d on_corners_N = Eigen::Matrix3d::Zero();
    for_each_pushed(corners_m, cut.divisions, center_m, radius_m_, [&](const PushedPlace& place) {
      on_corners_N += (cut.area_m2 * skin.pressure_Pa(place.depth_m) * place.outward) * place.weight.transpose();
    });
    surface.add_to_corners(triangle, on_corners_N, on_nodes_N);
  });
}

void SpherePressure::add_resistance(const DeformedSurface& surface, const scene::Point& center_m,
                                    PressedTriangles& pressed) const noexcept {
  const Skin skin{stiffness_Pa_per_m_, skin_m()};
  for_each_near(surface, center_m, [&](int triangle, const Eigen::Matrix3d& corners_m, const Cut& cut) {
    PressedTriangles::Resistance resistance = PressedTriangles::Resistance::Zero();
    bool any = false;
    for_each_pushed(corners_m, cut.divisions, center_m, radius_m_, [&](const PushedPlace& place) {
      // Stiff along the push; negative across it, as for anything that rests on a ball.
      const double across = -cut.area_m2 * skin.pressure_Pa(place.depth_m) / place.away_m;
      const double along = cut.area_m2 * skin.steepness_Pa_per_m(place.depth_m);
      Eigen::Matrix3d here = (along - across) * place.outward * place.outward.transpose();
      here.diagonal().array() += across;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          resistance.block<3, 3>(3 * a, 3 * b) += place.weight[a] * place.weight[b] * here;
        }
      }
      any = true;
    });
    if (any) pressed.add(triangle, resistance);
  });
}

SpherePressure::Touch SpherePressure::touch(const DeformedSurface& surface,
                                            const scene::Point& center_m) const noexcept {
  const Skin skin{stiffness_Pa_per_m_, skin_m()};
  Touch touch;
  for_each_near(surface, center_m, [&](int /*triangle*/, const Eigen::Matrix3d& corners_m, const Cut& cut) {
    for_each_pushed(corners_m, cut.divisions, center_m, radius_m_, [&](const PushedPlace& place) {
      touch.force_N -= cut.area_m2 * skin.pressure_Pa(place.depth_m) * place.outward;
      touch.deepest_m = std::max(touch.deepest_m, place.depth_m);
      ++touch.places;
    });
  });
  return touch;
}

double SpherePressure::depth_at_rest_m(const DeformedSurface& surface, const scene::Point& center_m,
                                       const scene::Point& normal) const noexcept {
  double depth_m = 0;
  for_each_near(surface, center_m, [&](int triangle, const Eigen::Matrix3d& corners_m, const Cut& cut) {
    for_each_pushed(corners_m, cut.divisions, center_m, radius_m_, [&](const PushedPlace& place) {
      const scene::Point rest_m = surface.at_rest().at({triangle, place.weight});
      depth_m = std::max(depth_m, SphereDepth(center_m - rest_m, normal, radius_m_).depth_m);
    });
  });
  return depth_m;
}

double SpherePressure::free_share(const DeformedSurface& surface, const scene::Point& from_m,
                                  const scene::Point& to_m) const noexcept {
  const scene::Point way_m = to_m - from_m;
  const double way_m2 = way_m.squaredNorm();
  double share = 1;
  for (int triangle = 0; triangle < static_cast<int>(cuts_.size()); ++triangle) {
    const Eigen::Matrix3d corners_m = surface.corners_m(triangle);
    if (!is_near(corners_m, from_m, way_m, radius_m_)) continue;
    const Eigen::Matrix3d from_here_m = corners_m.colwise() - from_m;
    for_each_centroid(cuts_[triangle].divisions, [&](const scene::Point& weight) {
      const scene::Point away_m = from_here_m * weight;
      const double towards_m2 = away_m.dot(way_m);
      if (!(towards_m2 > 0)) return;
      const double square_m2 = away_m.squaredNorm();
      const double near_m = nearest_m(std::sqrt(square_m2));
      // Where the segment meets the ball of that radius around the place.
      const double outside_m2 = square_m2 - near_m * near_m;
      const double root = towards_m2 * towards_m2 - way_m2 * outside_m2;
      if (outside_m2 <= 0) {
        share = 0;
      } else if (root > 0) {
        share = std::min(share, (towards_m2 - std::sqrt(root)) / way_m2);
      }
    });
  }
  return std::max(share, 0.0);
}

// The least distance from a place to which the centre may move by itself, given its present one.
double SpherePressure::nearest_m(double away_m) const noexcept {
  const double depth_m = std::max(radius_m_ - away_m, 0.0);
  return radius_m_ - std::min(0.5 * (depth_m + skin_m()), kDeepest * skin_m());
}

}  // namespace forcebound::tissue
