#include "forcebound/wire/internal/bodies.hpp"

#include <initializer_list>
#include <string>

#include "forcebound/wire/frame_size.hpp"
#include "forcebound/wire/internal/known_fields.hpp"

namespace forcebound::wire {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

// Elements that were cleared keep their memory, and so do their lists of numbers. Of each kind there is room for as
// many elements as a body can have.
void reserve_models(v1::EnvironmentForce& force) {
  const auto reserve = [](std::initializer_list<google::protobuf::RepeatedField<float>*> lists) {
    for (auto* const list : lists) list->Reserve(static_cast<int>(kFrameBytesMax / sizeof(float)));
  };
  for (int i = 0; i < KnownFields::kMessagesMax; ++i) {
    v1::ModelSurface& surface = *force.add_model_surface();
    reserve({surface.mutable_force_n(), surface.mutable_place_m(), surface.mutable_normal(),
             surface.mutable_stiffness_n_per_m(), surface.mutable_velocity_m_per_s(),
             surface.mutable_acceleration_m_per_s2()});
    v1::ModelMass& mass = *force.add_model_mass();
    reserve({mass.mutable_force_n(), mass.mutable_place_m(), mass.mutable_body(), mass.mutable_contacts(),
             mass.mutable_met()});
    v1::ModelField& field = *force.add_model_field();
    reserve({field.mutable_force_n(), field.mutable_place_m(), field.mutable_jacobian_n_per_m()});
  }
  force.Clear();
}

}  // namespace

// Grows every string and list to the most that a datagram can hold; clearing keeps their memory.
Bodies::Bodies() {
  const std::string longest(kFrameBytesMax, 'x');
  for (std::string* text :
       {hello.mutable_device(), hello.mutable_scene(), hello.mutable_server_law(), hello.mutable_padding(),
        welcome.mutable_scene(), welcome.mutable_simulated(), welcome.mutable_manifest_sha256(), refusal.mutable_text(),
        piece.mutable_content(), view.mutable_content()}) {
    *text = longest;
  }
  for (Numbers* numbers :
       {motion.mutable_position_m(), force.mutable_force_n(), force.mutable_torque_n_m(), welcome.mutable_tool_m(),
        force.mutable_server_parts_n(), force.mutable_position_m(), force.mutable_contact_normal(),
        force.mutable_texture_wave_rad_per_m(), force.mutable_texture_across_rad_per_m(),
        motion.mutable_server_law_numbers(), force.mutable_server_law_numbers()}) {
    numbers->Reserve(static_cast<int>(kFrameBytesMax / sizeof(double)));
  }
  motion.mutable_orientation()->Reserve(static_cast<int>(kFrameBytesMax / sizeof(float)));
  reserve_models(force);
  // The first call makes those of all messages.
  (void)v1::Hello::descriptor();
}

}  // namespace forcebound::wire
