// Replaces body_watch.cpp and synchronised.cpp without MuJoCo: no scene has rigid bodies then.
#include "tests/tools/lab/accuracy/body_watch.hpp"
#include "tests/tools/lab/accuracy/synchronised.hpp"

namespace forcebound::lab {

struct BodyWatch::Watched {};

BodyWatch::BodyWatch(const scene::SceneState&) {}
BodyWatch::~BodyWatch() = default;
bool BodyWatch::observe() { return true; }
BodyRecord BodyWatch::record() const { return {}; }

const server::BodyWorld* body_world(const scene::DynamicModelsNow&, std::size_t) { return nullptr; }

std::optional<Synchronised> run_synchronised(const std::vector<std::shared_ptr<const scene::Scene>>&, std::size_t,
                                             const std::vector<Vector>&) {
  return std::nullopt;
}

}  // namespace forcebound::lab
