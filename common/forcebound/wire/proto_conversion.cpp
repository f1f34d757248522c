#include <cmath>

#include "forcebound/wire/internal/proto_conversion.hpp"

namespace forcebound::wire {
namespace {

using RepeatedNumbers = google::protobuf::RepeatedField<double>;

template <class Rows>
void add_rows(const Rows& from, RepeatedNumbers* to) noexcept {
  for (Eigen::Index i = 0; i < from.rows(); ++i) to->Add(from[i]);
}

/// Converts fields one by one and notes invalid ones.
class FieldTaker {
 public:
  void time(std::int64_t ns, const char* field, Nanoseconds& to) noexcept {
    if (ns > kTimeMost.count() || ns < -kTimeMost.count()) {
      note(flaws_.time, {.field = field, .got = ns, .most = kTimeMost.count()});
    } else {
      to = Nanoseconds{ns};
    }
  }

  template <class Rows>
  void rows(const RepeatedNumbers& from, const char* field, Rows& to) noexcept {
    if (from.size() > Rows::MaxRowsAtCompileTime) {
      note(flaws_.rows, {.field = field, .got = from.size(), .most = Rows::MaxRowsAtCompileTime});
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
  static void note(Flaws::Flaw& first, const Flaws::Flaw& flaw) noexcept {
    if (first.field == nullptr) first = flaw;
  }

  Flaws flaws_;
};

}  // namespace

void fill(const MotionSample& from, v1::MotionSample& to) noexcept {
  to.Clear();
  to.set_session(from.session);
  to.set_sequence(from.sequence);
  to.set_device_time_ns(from.device_time.count());
  add_rows(from.position, to.mutable_position_m());
  add_rows(from.server_law_numbers, to.mutable_server_law_numbers());
}

Flaws take(const v1::MotionSample& from, MotionSample& to) noexcept {
  FieldTaker taker;
  to.session = from.session();
  to.sequence = from.sequence();
  taker.time(from.device_time_ns(), "device_time_ns", to.device_time);
  taker.rows(from.position_m(), "position_m", to.position);
  taker.rows(from.server_law_numbers(), "server_law_numbers", to.server_law_numbers);
  return taker.flaws();
}

void fill(const EnvironmentForce& from, v1::EnvironmentForce& to) noexcept {
  to.Clear();
  to.set_session(from.session);
  to.set_sequence(from.sequence);
  to.set_motion_sequence(from.motion_sequence);
  to.set_motion_device_time_ns(from.motion_device_time.count());
  add_rows(from.force, to.mutable_force_n());
  add_rows(from.position, to.mutable_position_m());
  add_rows(from.contact_normal, to.mutable_contact_normal());
  to.set_penetration_m(from.penetration_m);
  to.set_server_receive_time_ns(from.server_receive_time.count());
  to.set_server_send_time_ns(from.server_send_time.count());
  to.set_compute_time_ns(from.compute_time.count());
  to.set_motions_received(from.motions_received);
  to.set_motions_duplicated(from.motions_duplicated);
  to.set_motions_reordered(from.motions_reordered);
  to.set_texture_n(from.texture_N);
  add_rows(from.texture_wave, to.mutable_texture_wave_rad_per_m());
  add_rows(from.texture_across, to.mutable_texture_across_rad_per_m());
  add_rows(from.server_law_numbers, to.mutable_server_law_numbers());
}

Flaws take(const v1::EnvironmentForce& from, EnvironmentForce& to) noexcept {
  FieldTaker taker;
  to.session = from.session();
  to.sequence = from.sequence();
  to.motion_sequence = from.motion_sequence();
  taker.time(from.motion_device_time_ns(), "motion_device_time_ns", to.motion_device_time);
  taker.rows(from.force_n(), "force_N", to.force);
  taker.rows(from.position_m(), "position_m", to.position);
  taker.rows(from.contact_normal(), "contact_normal", to.contact_normal);
  taker.number(from.penetration_m(), to.penetration_m);
  taker.time(from.server_receive_time_ns(), "server_receive_time_ns", to.server_receive_time);
  taker.time(from.server_send_time_ns(), "server_send_time_ns", to.server_send_time);
  taker.time(from.compute_time_ns(), "compute_time_ns", to.compute_time);
  to.motions_received = from.motions_received();
  to.motions_duplicated = from.motions_duplicated();
  to.motions_reordered = from.motions_reordered();
  taker.number(from.texture_n(), to.texture_N);
  taker.rows(from.texture_wave_rad_per_m(), "texture_wave_rad_per_m", to.texture_wave);
  taker.rows(from.texture_across_rad_per_m(), "texture_across_rad_per_m", to.texture_across);
  taker.rows(from.server_law_numbers(), "server_law_numbers", to.server_law_numbers);
  return taker.flaws();
}

}  // namespace forcebound::wire
