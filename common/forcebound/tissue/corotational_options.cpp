#include "forcebound/tissue/corotational_options.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/text/numbers.hpp"

namespace forcebound::tissue {
namespace {

[[noreturn]] void refuse(const std::string& what, double value) {
  throw std::invalid_argument(what + ", got " + text::to_text(value));
}

// A skin of 1, see CorotationalOptions::kSkin.
double unit_skin_Pa_per_m(const ElasticMaterial& material, double radius_m) {
  return material.young_Pa / (1 - material.poisson * material.poisson) / radius_m;
}

}  // namespace

void CorotationalOptions::check(const ElasticMaterial& material) const {
  if (!(radius_m >= 0) || !std::isfinite(radius_m)) refuse("radius_m must be >= 0", radius_m);
  if (radius_m > 0) {
    const double most_Pa_per_m = kSkinMost * unit_skin_Pa_per_m(material, radius_m);
    if (!(contact_stiffness_Pa_per_m >= 0 && contact_stiffness_Pa_per_m <= most_Pa_per_m)) {
      refuse("contact_stiffness_Pa_per_m must be > 0 and <= " + text::to_text(most_Pa_per_m) +
                 " for that material and radius",
             contact_stiffness_Pa_per_m);
    }
  } else if (!(contact_stiffness_N_per_m > 0 && contact_stiffness_N_per_m <= kContactStiffnessMost_N_per_m)) {
    refuse("contact_stiffness_N_per_m must be > 0 and <= " + text::to_text(kContactStiffnessMost_N_per_m) +
               " under large motion",
           contact_stiffness_N_per_m);
  }
  if (iterations_max < 1) refuse("iterations_max must be >= 1", iterations_max);
  if (linear_iterations_max < 1) refuse("linear_iterations_max must be >= 1", linear_iterations_max);
  if (!(tolerance > 0 && tolerance < 1)) refuse("tolerance must be > 0 and < 1", tolerance);
}

double CorotationalOptions::skin_Pa_per_m(const ElasticMaterial& material) const noexcept {
  return contact_stiffness_Pa_per_m > 0 ? contact_stiffness_Pa_per_m : kSkin * unit_skin_Pa_per_m(material, radius_m);
}

}  // namespace forcebound::tissue
