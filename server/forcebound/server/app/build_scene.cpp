#include "forcebound/server/app/build_scene.hpp"

#include <chrono>
#include <iostream>

#include "forcebound/server/app/notice_after.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {

std::shared_ptr<const scene::Scene> build_scene(const ProgramOptions& options, const scene::MeasureCost& measure) {
  constexpr std::chrono::seconds kSilence{3};
  const NoticeAfter notice(kSilence, [&options] {
    std::cerr << std::string(kProgram) + ": still building the scene '" + text::printable(options.scene) +
                     "', after 3 s; a tissue may take 30 s\n";
  });
  return load_scene(options.scene, scene::Registry::standard(), measure, options.scene_files);
}

}  // namespace forcebound::server
