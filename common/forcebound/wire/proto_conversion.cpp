#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "forcebound/wire/internal/proto_conversion.hpp"

namespace forcebound::wire {
namespace {

using RepeatedNumbers = google::protobuf::RepeatedField<double>;

template <class Rows>
void add_rows(const Rows& from, RepeatedNumbers* to) noexcept {
  for (Eigen::Index i = 0; i < from.rows(); ++i) to->Add(from[i]);
}

/// Converts fields one by one and notes invalid ones.
class FieldReader {
 public:
  void time(std::int64_t ns, const char* field, Nanoseconds& to) noexcept {
    if (ns > kTimeMost.count() || ns < -kTimeMost.count()) {
      store_first(flaws_.time, {.field = field, .got = ns, .most = kTimeMost.count()});
    } else {
      to = Nanoseconds{ns};
    }
  }

  template <class Rows>
  void rows(const RepeatedNumbers& from, const char* field, Rows& to) noexcept {
    // A vector's storage has room for the joints of an arm; what travels belongs to tips.
    constexpr int kMost = std::is_same_v<Rows, control::Vector> ? control::kDofMax : Rows::MaxRowsAtCompileTime;
    if (from.size() > kMost) {
      store_first(flaws_.rows, {.field = field, .got = from.size(), .most = kMost});
      return;
    }
    to.resize(from.size());
    for (int i = 0; i < from.size(); ++i) to[i] = from[i];
    flaws_.not_finite |= !to.allFinite();
  }

  void number(double from, double& to) noexcept {
    to = from;
    flaws_.not_finite |= !std::isfinite(from);
  }

  [[nodiscard]] const Flaws& flaws() const noexcept { return flaws_; }

 private:
  static void store_first(Flaws::Flaw& first, const Flaws::Flaw& flaw) noexcept {
    if (first.field == nullptr) first = flaw;
  }

  Flaws flaws_;
};

using RepeatedFloats = google::protobuf::RepeatedField<float>;
using local_model::LocalModel;
using local_model::Point;

void add_point(const Point& from, RepeatedFloats* to) noexcept {
  for (Eigen::Index axis = 0; axis < 3; ++axis) to->Add(static_cast<float>(from[axis]));
}

void add_point_unless_zero(const Point& from, RepeatedFloats* to) noexcept {
  if (!from.isZero(0)) add_point(from, to);
}

void add_symmetric(const Eigen::Matrix3d& from, RepeatedFloats* to) noexcept {
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = row; column < 3; ++column) to->Add(static_cast<float>(from(row, column)));
  }
}

/// Takes one number after the other.
class NumbersOf {
 public:
  explicit NumbersOf(const RepeatedFloats& from, int first = 0) noexcept : from_(from), next_(first) {}
  double number() noexcept { return static_cast<double>(from_.Get(next_++)); }
  Point point() noexcept {
    Point to;
    for (double& axis : to) axis = number();
    return to;
  }
  Eigen::Matrix3d symmetric() noexcept {
    Eigen::Matrix3d to;
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = row; column < 3; ++column) to(row, column) = to(column, row) = number();
    }
    return to;
  }
  // Members in the order in which they are read.
  local_model::Body body() noexcept {
    return {.velocity_m_per_s = point(),
            .bias_m_per_s2 = point(),
            .mobility_per_kg = symmetric(),
            .spring_N_per_m = number(),
            .damper_N_s_per_m = number(),
            .dry_friction_N = number()};
  }
  local_model::Contact contact() noexcept {
    return {.normal = point(),
            .gap_m = number(),
            .compliance_per_kg = number(),
            .stiffness_per_s2 = number(),
            .damping_per_s = number(),
            .friction = number(),
            .radius_m = number(),
            .travel_m = number(),
            .return_m = number()};
  }

 private:
  const RepeatedFloats& from_;
  int next_;
};

/// Not a number where there are not as many as there should be: the model is then unsound.
Point point_of(const RepeatedFloats& from) noexcept {
  if (from.size() != 3) return Point::Constant(std::numeric_limits<double>::quiet_NaN());
  return NumbersOf(from).point();
}

Point point_or_zero(const RepeatedFloats& from) noexcept {
  return from.empty() ? Point(Point::Zero()) : point_of(from);
}

Eigen::Matrix3d symmetric_of(const RepeatedFloats& from) noexcept {
  if (from.size() != 6) return Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return NumbersOf(from).symmetric();
}

// Of EnvironmentForce's model_bits: one number, since a frame has no room for one in each part.
constexpr std::uint32_t kByDeviceClock = 1;
constexpr std::uint32_t kOthersMoveSurface = 2;  // the first; those of the others follow
constexpr std::uint32_t kOthersMoveMass = kOthersMoveSurface << LocalModel::kSurfacesMax;

void fill(const local_model::Surface& from, v1::ModelSurface& to) noexcept {
  to.set_id(from.id);
  add_point(from.force_N, to.mutable_force_n());
  add_point(from.place_m, to.mutable_place_m());
  add_point(from.normal, to.mutable_normal());
  add_symmetric(from.stiffness_N_per_m, to.mutable_stiffness_n_per_m());
  to.set_damping_n_s_per_m(static_cast<float>(from.damping_N_s_per_m));
  add_point_unless_zero(from.velocity_m_per_s, to.mutable_velocity_m_per_s());
  add_point_unless_zero(from.acceleration_m_per_s2, to.mutable_acceleration_m_per_s2());
  to.set_relaxing_n_per_m(static_cast<float>(from.relaxing_N_per_m));
  to.set_relaxation_s(static_cast<float>(from.relaxation_s));
  to.set_relaxed_n(static_cast<float>(from.relaxed_N));
  to.set_friction(static_cast<float>(from.friction));
  to.set_radius_m(static_cast<float>(from.radius_m));
}

local_model::Surface to_model(const v1::ModelSurface& from) noexcept {
  return {.id = from.id(),
          .force_N = point_of(from.force_n()),
          .place_m = point_of(from.place_m()),
          .normal = point_of(from.normal()),
          .stiffness_N_per_m = symmetric_of(from.stiffness_n_per_m()),
          .damping_N_s_per_m = static_cast<double>(from.damping_n_s_per_m()),
          .velocity_m_per_s = point_or_zero(from.velocity_m_per_s()),
          .acceleration_m_per_s2 = point_or_zero(from.acceleration_m_per_s2()),
          .relaxing_N_per_m = static_cast<double>(from.relaxing_n_per_m()),
          .relaxation_s = static_cast<double>(from.relaxation_s()),
          .relaxed_N = static_cast<double>(from.relaxed_n()),
          .friction = static_cast<double>(from.friction()),
          .radius_m = static_cast<double>(from.radius_m())};
}

// The numbers of a body and of a contact, in the order of the schema: both ways.
constexpr int kBodyNumbers = 15;
constexpr int kContactNumbers = 11;

void add_number(double number, RepeatedFloats* to) noexcept { to->Add(static_cast<float>(number)); }

void add(const local_model::Body& from, RepeatedFloats* to) noexcept {
  add_point(from.velocity_m_per_s, to);
  add_point(from.bias_m_per_s2, to);
  add_symmetric(from.mobility_per_kg, to);
  for (const double number : {from.spring_N_per_m, from.damper_N_s_per_m, from.dry_friction_N}) add_number(number, to);
}

void add(const local_model::Contact& from, RepeatedFloats* to) noexcept {
  add_point(from.normal, to);
  for (const double number : {from.gap_m, from.compliance_per_kg, from.stiffness_per_s2, from.damping_per_s,
                              from.friction, from.radius_m, from.travel_m, from.return_m})
    add_number(number, to);
}

void fill(const local_model::Mass& from, v1::ModelMass& to) noexcept {
  to.set_id(from.id);
  add_point(from.force_N, to.mutable_force_n());
  add_point(from.place_m, to.mutable_place_m());
  to.set_stiffness_n_per_m(static_cast<float>(from.stiffness_N_per_m));
  to.set_damping_n_s_per_m(static_cast<float>(from.damping_N_s_per_m));
  add(from.body, to.mutable_body());
  const auto contacts = std::span(from.contacts).first(std::min(from.contact_count, local_model::Mass::kContactsMax));
  const auto last = std::find_if(contacts.rbegin(), contacts.rend(), [](const auto& one) { return one.moves(); });
  for (const local_model::Contact& contact : contacts) add(contact, to.mutable_contacts());
  for (const local_model::Contact& contact : contacts.first(static_cast<std::size_t>(contacts.rend() - last)))
    add(contact.met, to.mutable_met());
  to.set_radius_m(static_cast<float>(from.radius_m));
}

/// Of another number of numbers than a mass has it becomes unsound.
local_model::Mass to_model(const v1::ModelMass& from) noexcept {
  constexpr int kMost = static_cast<int>(local_model::Mass::kContactsMax);
  local_model::Mass to{.id = from.id(),
                       .force_N = point_of(from.force_n()),
                       .place_m = point_of(from.place_m()),
                       .stiffness_N_per_m = static_cast<double>(from.stiffness_n_per_m()),
                       .damping_N_s_per_m = static_cast<double>(from.damping_n_s_per_m()),
                       .contact_count = local_model::Mass::kContactsMax + 1,
                       .radius_m = static_cast<double>(from.radius_m())};
  const int contacts = from.contacts_size() / kContactNumbers;
  const int met = from.met_size() / kBodyNumbers;
  const bool whole = from.contacts_size() % kContactNumbers == 0 && from.met_size() % kBodyNumbers == 0;
  if (from.body_size() != kBodyNumbers || !whole || contacts > kMost || met > contacts) return to;
  to.body = NumbersOf(from.body()).body();
  for (int i = 0; i < contacts; ++i) {
    local_model::Contact& contact = to.contacts.at(static_cast<std::size_t>(i));
    contact = NumbersOf(from.contacts(), i * kContactNumbers).contact();
    if (i < met) contact.met = NumbersOf(from.met(), i * kBodyNumbers).body();
  }
  to.contact_count = static_cast<std::uint32_t>(contacts);
  return to;
}

void fill(const local_model::Field& from, v1::ModelField& to) noexcept {
  add_point(from.force_N, to.mutable_force_n());
  add_point(from.place_m, to.mutable_place_m());
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column)
      to.add_jacobian_n_per_m(static_cast<float>(from.jacobian_N_per_m(row, column)));
  }
  to.set_radius_m(static_cast<float>(from.radius_m));
}

local_model::Field to_model(const v1::ModelField& from) noexcept {
  local_model::Field to{.force_N = point_of(from.force_n()),
                        .place_m = point_of(from.place_m()),
                        .jacobian_N_per_m = Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN()),
                        .radius_m = static_cast<double>(from.radius_m())};
  if (from.jacobian_n_per_m_size() != 9) return to;
  for (int i = 0; i < 9; ++i) to.jacobian_N_per_m(i / 3, i % 3) = static_cast<double>(from.jacobian_n_per_m(i));
  return to;
}

void fill(const LocalModel& from, v1::EnvironmentForce& to) noexcept {
  std::uint32_t bits = from.by_device_clock ? kByDeviceClock : 0U;
  to.set_model_before_reading_ns(from.before_reading.count());
  const std::uint32_t surfaces = std::min(from.surface_count, LocalModel::kSurfacesMax);
  for (std::uint32_t i = 0; i < surfaces; ++i) {
    fill(from.surfaces.at(i), *to.add_model_surface());
    if (from.surfaces.at(i).others_move_it) bits |= kOthersMoveSurface << i;
  }
  if (from.has_mass) {
    fill(from.mass, *to.add_model_mass());
    if (from.mass.others_move_it) bits |= kOthersMoveMass;
  }
  to.set_model_bits(bits);
  if (from.has_field) fill(from.field, *to.add_model_field());
}

/// More than there is room for makes it unsound.
void read(const v1::EnvironmentForce& from, LocalModel& to) noexcept {
  constexpr int kRoom = static_cast<int>(LocalModel::kSurfacesMax);
  const bool fits = from.model_surface_size() <= kRoom && from.model_mass_size() <= 1 && from.model_field_size() <= 1;
  to.by_device_clock = (from.model_bits() & kByDeviceClock) != 0;
  to.before_reading = std::chrono::nanoseconds{from.model_before_reading_ns()};
  to.surface_count = fits ? static_cast<std::uint32_t>(from.model_surface_size()) : LocalModel::kSurfacesMax + 1;
  for (int i = 0; fits && i < from.model_surface_size(); ++i) {
    local_model::Surface& surface = to.surfaces.at(static_cast<std::size_t>(i));
    surface = to_model(from.model_surface(i));
    surface.others_move_it = (from.model_bits() & kOthersMoveSurface << static_cast<std::uint32_t>(i)) != 0;
  }
  to.has_mass = from.model_mass_size() > 0;
  if (to.has_mass) {
    to.mass = to_model(from.model_mass(0));
    to.mass.others_move_it = (from.model_bits() & kOthersMoveMass) != 0;
  }
  to.has_field = from.model_field_size() > 0;
  if (to.has_field) to.field = to_model(from.model_field(0));
}

void fill(const control::Handle& from, v1::MotionSample& to) noexcept {
  if (from.buttons) to.set_buttons(*from.buttons);
  if (from.gripper) to.set_gripper(static_cast<float>(*from.gripper));
  if (!from.orientation) return;
  for (const double number : *from.orientation) to.add_orientation(static_cast<float>(number));
}

/// An orientation that has not four numbers is none.
void read(const v1::MotionSample& from, FieldReader& reader, control::Handle& to) noexcept {
  if (from.has_buttons()) to.buttons = from.buttons();
  if (from.has_gripper()) reader.number(static_cast<double>(from.gripper()), to.gripper.emplace());
  if (from.orientation_size() != static_cast<int>(control::Handle::Orientation{}.size())) return;
  control::Handle::Orientation& orientation = to.orientation.emplace();
  for (std::size_t i = 0; i < orientation.size(); ++i)
    reader.number(static_cast<double>(from.orientation(static_cast<int>(i))), orientation.at(i));
}

}  // namespace

void fill(const MotionSample& from, v1::MotionSample& to) noexcept {
  to.Clear();
  to.set_session(from.session);
  to.set_sequence(from.sequence);
  to.set_device_time_ns(from.device_time.count());
  add_rows(from.position, to.mutable_position_m());
  add_rows(from.server_law_numbers, to.mutable_server_law_numbers());
  to.set_pieces_wanted(from.pieces.wanted);
  to.set_piece_newest(from.pieces.newest);
  to.set_piece_map(from.pieces.before);
  to.set_challenge(from.challenge);
  fill(from.handle, to);
  to.set_energy_given_j(from.energy_given_J);
}

Flaws read(const v1::MotionSample& from, MotionSample& to) noexcept {
  FieldReader reader;
  to.session = from.session();
  to.sequence = from.sequence();
  reader.time(from.device_time_ns(), "device_time_ns", to.device_time);
  reader.rows(from.position_m(), "position_m", to.position);
  reader.rows(from.server_law_numbers(), "server_law_numbers", to.server_law_numbers);
  to.pieces = {.wanted = from.pieces_wanted(), .newest = from.piece_newest(), .before = from.piece_map()};
  to.challenge = from.challenge();
  read(from, reader, to.handle);
  reader.number(from.energy_given_j(), to.energy_given_J);
  return reader.flaws();
}

void fill(const EnvironmentForce& from, v1::EnvironmentForce& to) noexcept {
  to.Clear();
  to.set_session(from.session);
  to.set_sequence(from.sequence);
  to.set_motion_sequence(from.motion_sequence);
  to.set_motion_device_time_ns(from.motion_device_time.count());
  add_rows(from.answer.force, to.mutable_force_n());
  add_rows(from.answer.torque_N_m, to.mutable_torque_n_m());
  add_rows(from.position, to.mutable_position_m());
  add_rows(from.answer.contact_normal, to.mutable_contact_normal());
  to.set_penetration_m(from.answer.penetration_m);
  to.set_server_receive_time_ns(from.server_receive_time.count());
  to.set_server_send_time_ns(from.server_send_time.count());
  to.set_compute_time_ns(from.compute_time.count());
  to.set_motions_received(from.motions_received);
  to.set_motions_duplicated(from.motions_duplicated);
  to.set_motions_reordered(from.motions_reordered);
  to.set_texture_n(from.answer.texture_N);
  add_rows(from.answer.texture_wave, to.mutable_texture_wave_rad_per_m());
  add_rows(from.answer.texture_across, to.mutable_texture_across_rad_per_m());
  add_rows(from.server_law_numbers, to.mutable_server_law_numbers());
  add_rows(from.answer.server_parts_N, to.mutable_server_parts_n());
  to.set_texture_in_server_parts(from.answer.texture_in_server_parts);
  to.set_challenge(from.challenge);
  to.set_follower_state(static_cast<std::uint32_t>(from.answer.follower));
  if (!from.answer.model.empty()) fill(from.answer.model, to);
}

Flaws read(const v1::EnvironmentForce& from, EnvironmentForce& to) noexcept {
  FieldReader reader;
  to.session = from.session();
  to.sequence = from.sequence();
  to.motion_sequence = from.motion_sequence();
  reader.time(from.motion_device_time_ns(), "motion_device_time_ns", to.motion_device_time);
  reader.rows(from.force_n(), "force_N", to.answer.force);
  reader.rows(from.torque_n_m(), "torque_N_m", to.answer.torque_N_m);
  reader.rows(from.position_m(), "position_m", to.position);
  reader.rows(from.contact_normal(), "contact_normal", to.answer.contact_normal);
  reader.number(from.penetration_m(), to.answer.penetration_m);
  reader.time(from.server_receive_time_ns(), "server_receive_time_ns", to.server_receive_time);
  reader.time(from.server_send_time_ns(), "server_send_time_ns", to.server_send_time);
  reader.time(from.compute_time_ns(), "compute_time_ns", to.compute_time);
  to.motions_received = from.motions_received();
  to.motions_duplicated = from.motions_duplicated();
  to.motions_reordered = from.motions_reordered();
  reader.number(from.texture_n(), to.answer.texture_N);
  reader.rows(from.texture_wave_rad_per_m(), "texture_wave_rad_per_m", to.answer.texture_wave);
  reader.rows(from.texture_across_rad_per_m(), "texture_across_rad_per_m", to.answer.texture_across);
  reader.rows(from.server_law_numbers(), "server_law_numbers", to.server_law_numbers);
  reader.rows(from.server_parts_n(), "server_parts_N", to.answer.server_parts_N);
  to.answer.texture_in_server_parts = from.texture_in_server_parts();
  to.challenge = from.challenge();
  to.answer.follower = control::follower_state_of(from.follower_state());
  read(from, to.answer.model);
  return reader.flaws();
}

}  // namespace forcebound::wire
