#include "forcebound/tissue/other_contacts.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "forcebound/tissue/sphere_depth.hpp"

namespace forcebound::tissue {
namespace {

using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;

}  // namespace

OtherContacts::OtherContacts(const LinearTissue& tissue, const ProbeOptions& options)
    : tissue_(tissue),
      radius_m_(options.radius_m),
      yield_m_per_N_(1 / options.contact_stiffness_N_per_m),
      moved_(static_cast<std::size_t>(tissue_.surface_nodes())) {
  // C is positive semidefinite: no block of it is larger than those on the diagonal.
  for (int node = 0; node < tissue_.surface_nodes(); ++node) {
    compliance_m_per_N_max_ = std::max(compliance_m_per_N_max_, tissue_.compliance_m_per_N(node, node).trace());
  }
  factor_.resize(kRowsMax, kRowsMax);
  clear();
}

void OtherContacts::clear() noexcept {
  contact_count_ = 0;
  drive_.resize(0);
  begin_alone();
}

int OtherContacts::add(const TissueState& probe) noexcept {
  const scene::Point probe_m = scene::to_point(probe.probe_m);
  int left_out = 0;
  for (std::uint32_t k = 0; k < probe.contacts; ++k) {
    Contact contact{.place = place_of(probe.contact[k]), .directions = Eigen::Matrix3d::Identity()};
    contact.depth_m = probe_m - tissue_.surface().at(contact.place);
    if (radius_m_ > 0) {
      const scene::Point direction = scene::to_point(probe.direction);
      contact.depth_m.x() = SphereDepth(contact.depth_m, direction, radius_m_).depth_m;
      contact.directions = -direction;
    }
    if (rows() + contact.directions.cols() > kRowsMax) {
      ++left_out;
      continue;
    }
    put_in(contact);
    contacts_[contact_count_++] = contact;
  }
  begin_alone();
  return left_out;
}

// Appends the contact's rows of L and y.
void OtherContacts::put_in(Contact& contact) noexcept {
  const Eigen::Index before = rows();
  const Eigen::Index size = contact.directions.cols();
  const Rows coupling = coupled(contact.place, contact.directions);
  SmallMatrix left =
      contact.directions.transpose() * tissue_.compliance_m_per_N(contact.place, contact.place) * contact.directions;
  left.diagonal().array() += yield_m_per_N_;
  left -= coupling.transpose().lazyProduct(coupling);
  const Eigen::LLT<SmallMatrix> factor(left);
  contact.first_row = static_cast<int>(before);
  factor_.block(before, 0, size, before) = coupling.transpose();
  factor_.block(before, before, size, size) = factor.matrixL();
  const auto known = Row(drive_);
  drive_.resize(before + size);
  drive_.head(before) = known;
  drive_.tail(size) = factor.matrixL().solve(contact.depth_m.head(size) - coupling.transpose().lazyProduct(known));
}

OtherContacts::Rows OtherContacts::coupled(const SurfacePlace& place, const Directions& directions) const noexcept {
  Rows rows_m_per_N(rows(), directions.cols());
  for (int k = 0; k < contact_count_ && contacts_[k].first_row < rows(); ++k) {
    const Contact& contact = contacts_[k];
    rows_m_per_N.middleRows(contact.first_row, contact.directions.cols()) =
        contact.directions.transpose() * tissue_.compliance_m_per_N(contact.place, place) * directions;
  }
  for (Eigen::Index row = 0; row < rows(); ++row) {
    rows_m_per_N.row(row) -= factor_.row(row).head(row).lazyProduct(rows_m_per_N.topRows(row));
    rows_m_per_N.row(row) /= factor_(row, row);
  }
  return rows_m_per_N;
}

// Solves L' x = right for x.
OtherContacts::Row OtherContacts::solved_upward(Row right) const noexcept {
  for (Eigen::Index row = rows() - 1; row >= 0; --row) {
    right[row] /= factor_(row, row);
    right.head(row) -= right[row] * factor_.row(row).head(row).transpose();
  }
  return right;
}

void OtherContacts::begin_alone() noexcept {
  alone_N_ = solved_upward(drive_);
  yielded_N_ = Row::Zero(rows());
  ++now_;
}

void OtherContacts::respond(const Row& pushed) noexcept { yielded_N_ = solved_upward(-pushed); }

bool OtherContacts::drop_pulling() noexcept {
  const Row force_N = alone_N_ + yielded_N_;
  const auto end = contacts_.begin() + contact_count_;
  const auto kept = std::remove_if(contacts_.begin(), end, [&](const Contact& c) { return pulls(c, force_N); });
  if (kept == end) return false;
  drive_.resize(0);
  contact_count_ = 0;
  for (auto contact = contacts_.begin(); contact != kept; ++contact, ++contact_count_) put_in(*contact);
  begin_alone();
  return true;
}

scene::Point OtherContacts::force_of(const Contact& contact, const Row& force_N) const noexcept {
  return contact.directions * force_N.segment(contact.first_row, contact.directions.cols());
}

bool OtherContacts::pulls(const Contact& contact, const Row& force_N) const noexcept {
  return force_of(contact, force_N).dot(tissue_.surface().triangle_normal(contact.place.triangle)) > 0;
}

scene::Point OtherContacts::moved_under(const Row& force_N, int node) const noexcept {
  scene::Point moved_m = scene::Point::Zero();
  for (int k = 0; k < contact_count_; ++k) {
    const scene::Point here_N = force_of(contacts_[k], force_N);
    const auto& nodes = tissue_.surface().triangles()[contacts_[k].place.triangle];
    for (int corner = 0; corner < 3; ++corner) {
      const double weight = contacts_[k].place.weight[corner];
      if (weight > 0) moved_m += tissue_.compliance_m_per_N(node, nodes[corner]) * (weight * here_N);
    }
  }
  return moved_m;
}

scene::Point OtherContacts::moved_m(int node) noexcept {
  Moved& known = moved_[node];
  if (known.as_of != now_) known = {moved_under(alone_N_, node), now_};
  return known.by_m;
}

scene::Point OtherContacts::moved_m(const SurfacePlace& place) noexcept {
  scene::Point sum_m = scene::Point::Zero();
  for (int corner = 0; corner < 3; ++corner) {
    if (!(place.weight[corner] > 0)) continue;
    sum_m += place.weight[corner] * moved_m(tissue_.surface().triangles()[place.triangle][corner]);
  }
  return sum_m;
}

double OtherContacts::reach_m() const noexcept {
  double sum_N = 0;
  for (int k = 0; k < contact_count_; ++k) sum_N += force_of(contacts_[k], alone_N_).norm();
  return compliance_m_per_N_max_ * sum_N;
}

}  // namespace forcebound::tissue
