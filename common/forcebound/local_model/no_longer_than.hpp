#pragma once

#include <cmath>

namespace forcebound::local_model {

/// A vector, shortened to a length where it is longer, also where its length is beyond a double. One that is not finite
/// does not become so. Real time.
template <class AnyVector>
[[nodiscard]] AnyVector no_longer_than(const AnyVector& vector, double most) noexcept {
  const double length = vector.norm();
  if (!(length > most)) return vector;
  if (std::isfinite(length)) return vector * (most / length);
  const AnyVector share = vector / vector.cwiseAbs().maxCoeff();
  return share * (most / share.norm());
}

}  // namespace forcebound::local_model
