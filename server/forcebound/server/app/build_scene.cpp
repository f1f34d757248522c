#include "forcebound/server/app/build_scene.hpp"

#include <chrono>
#include <iostream>

#include "forcebound/server/app/notice_after.hpp"
#include "forcebound/server/app/options.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {

std::shared_ptr<const scene::Scene> build_scene(const std::string& name_or_file, const scene::MeasureCost& measure) {
  constexpr std::chrono::seconds kSilence{3};
  const NoticeAfter notice(kSilence, [&name_or_file] {
    std::cerr << std::string(kProgram) + ": still building the scene '" + text::printable(name_or_file) +
                     "', after 3 s\n";
  });
  return load_scene(name_or_file, scene::Registry::standard(), measure);
}

}  // namespace forcebound::server
