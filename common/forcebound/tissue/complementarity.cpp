#include "forcebound/tissue/complementarity.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <limits>

namespace forcebound::tissue {
namespace {

// Less than this share of the deepest contact is rounding.
constexpr double kRounding = 1e-13;

class ActiveSet {
 public:
  ActiveSet(const ContactMatrix& compliance, const ContactVector& gap)
      : compliance_(compliance), gap_(gap), force_(ContactVector::Zero(gap.size())) {}

  // The contact that lies deepest under the forces so far, among those without one; negative if none does.
  [[nodiscard]] Eigen::Index deepest() const noexcept {
    if (gap_.size() == 0) return -1;
    const double touching_m = -kRounding * gap_.cwiseAbs().maxCoeff();
    const ContactVector gap = compliance_ * force_ + gap_;
    Eigen::Index found = -1;
    for (Eigen::Index k = 0; k < gap.size(); ++k) {
      if (!pushes_[k] && gap[k] < touching_m && (found < 0 || gap[k] < gap[found])) found = k;
    }
    return found;
  }

  void let_push(Eigen::Index contact) noexcept { pushes_[contact] = true; }

  // Towards the forces at which all that push touch; true if none of them would pull.
  bool settle() noexcept {
    const ContactVector wanted = touching();
    double share = 1;
    for (Eigen::Index k = 0; k < wanted.size(); ++k) {
      if (pushes_[k] && !(wanted[k] > 0)) share = std::min(share, force_[k] / (force_[k] - wanted[k]));
    }
    if (!(share < 1) && !first_pull(wanted)) {
      force_ = wanted;
      return true;
    }
    force_ += std::max(share, 0.0) * (wanted - force_);
    const double least_N = kRounding * force_.maxCoeff();
    for (Eigen::Index k = 0; k < wanted.size(); ++k) {
      if (pushes_[k] && wanted[k] <= 0 && force_[k] <= least_N) pushes_[k] = false;
      if (!pushes_[k]) force_[k] = 0;
    }
    return false;
  }

  [[nodiscard]] const ContactVector& force() const noexcept { return force_; }

 private:
  [[nodiscard]] bool first_pull(const ContactVector& wanted) const noexcept {
    for (Eigen::Index k = 0; k < wanted.size(); ++k) {
      if (pushes_[k] && !(wanted[k] > 0)) return true;
    }
    return false;
  }

  [[nodiscard]] ContactVector touching() const noexcept {
    std::array<Eigen::Index, kContactsMax> index{};
    Eigen::Index size = 0;
    for (Eigen::Index k = 0; k < gap_.size(); ++k) {
      if (pushes_[k]) index[size++] = k;
    }
    ContactMatrix matrix(size, size);
    ContactVector depth(size);
    for (Eigen::Index row = 0; row < size; ++row) {
      depth[row] = -gap_[index[row]];
      for (Eigen::Index column = 0; column < size; ++column) {
        matrix(row, column) = compliance_(index[row], index[column]);
      }
    }
    const ContactVector solved = matrix.llt().solve(depth);
    ContactVector wanted = ContactVector::Zero(gap_.size());
    for (Eigen::Index row = 0; row < size; ++row) wanted[index[row]] = solved[row];
    return wanted;
  }

  const ContactMatrix& compliance_;
  const ContactVector& gap_;
  ContactVector force_;
  std::array<bool, kContactsMax> pushes_{};
};

double residual(const ContactMatrix& compliance, const ContactVector& gap_m, const ContactVector& force) noexcept {
  const ContactVector gap = compliance * force + gap_m;
  double largest_m = 0;
  for (Eigen::Index k = 0; k < gap.size(); ++k) {
    largest_m = std::max(largest_m, std::abs(std::min(compliance(k, k) * force[k], gap[k])));
  }
  return largest_m;
}

}  // namespace

Complementarity solve_contacts(const ContactMatrix& compliance_m_per_N, const ContactVector& gap_m,
                               int iterations_max) noexcept {
  Complementarity found;
  ActiveSet set(compliance_m_per_N, gap_m);
  while (found.iterations < iterations_max) {
    const Eigen::Index contact = set.deepest();
    if (contact < 0) break;
    set.let_push(contact);
    bool settled = false;
    while (!settled && found.iterations < iterations_max) {
      ++found.iterations;
      settled = set.settle();
    }
  }
  found.force_N = set.force();
  found.residual_m = residual(compliance_m_per_N, gap_m, found.force_N);
  return found;
}

}  // namespace forcebound::tissue
