#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>

#include "forcebound/scene/effects/surface.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/session/answer_size.hpp"
#include "forcebound/time/heap_operations.hpp"

/// Moves a device through a hundred objects that ask for one effect each, and prints the results.
///
///     scene_cost_counter only|all MOTIONS
///
/// `only`: that effect alone is registered; `all`: every other shipped effect too, and some whose construction ends the
/// program.
namespace forcebound::server {
namespace {

scene::Registry registry(const std::string& which) {
  if (which == "only") {
    scene::Registry only;
    only.add(scene::sphere_shape());
    only.add(scene::surface_effect());
    return only;
  }
  scene::Registry all = scene::Registry::standard();
  for (const char* name : {"bomb_1", "bomb_2", "bomb_3"}) {
    all.add(
        {.name = name, .purpose = "", .law = "", .make = [](const scene::Values&) -> std::unique_ptr<scene::Effect> {
           std::abort();
         }});
  }
  return all;
}

std::string hundred_objects() {
  std::string text = "[scene]\nname = 'hundred'\ndescription = ''\ndegrees_of_freedom = 3\n";
  for (int i = 0; i < 100; ++i) {
    text += "[[object]]\nname = 'ball " + std::to_string(i) + "'\nshape = { kind = 'sphere', center_m = [" +
            std::to_string(0.01 * i) +
            ", 0, 0], radius_m = 0.02 }\neffects = ['surface']\nsurface = { stiffness_N_per_m = 500 }\n";
  }
  return text;
}

/// FNV-1a over the bits.
std::uint64_t hash(std::uint64_t so_far, const control::Vector& force) {
  for (Eigen::Index i = 0; i < force.rows(); ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &force[i], sizeof bits);
    so_far = (so_far ^ bits) * 0x100000001b3;
  }
  return so_far;
}

void run(const std::string& which, int motions) {
  const auto scene = parse_scene(hundred_objects(), "hundred.toml", registry(which));
  scene::SceneState state(scene, 3);
  std::uint64_t forces = 0xcbf29ce484222325;
  const std::uint64_t heap_before = time::heap_operations_of_this_thread();
  for (int i = 0; i < motions; ++i) {
    control::Vector position(3);
    position << 0.001 * (i % 1000), 0.004, 0.0002 * (i % 100);
    forces = hash(forces, state.answer(position, std::chrono::milliseconds{i}).force);
  }
  const std::uint64_t heap_operations = time::heap_operations_of_this_thread() - heap_before;
  std::cout << "forces " << std::hex << forces << std::dec << "\nheap operations " << heap_operations
            << "\nbytes an answer " << answer_bytes(*scene) << "\nbytes of state " << scene->plan().state_bytes()
            << "\n";
}

}  // namespace
}  // namespace forcebound::server

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  forcebound::server::run(argv[1], std::atoi(argv[2]));
  return 0;
}
