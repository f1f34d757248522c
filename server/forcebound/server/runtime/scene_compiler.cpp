#include "forcebound/server/runtime/scene_compiler.hpp"

#include <exception>
#include <new>
#include <utility>

namespace forcebound::server {

SceneCompiler::SceneCompiler(SceneLibrary library,
                             std::function<void(std::string_view scene, std::string_view why)> failed)
    : library_(std::move(library)),
      failed_(std::move(failed)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {
  library_.compile_elsewhere([this](SceneLibrary::Compilation compilation) {
    {
      const std::lock_guard lock(guard_);
      wanted_.push_back(std::move(compilation));
    }
    wanted_changed_.notify_one();
  });
}

SceneCompiler::~SceneCompiler() { library_.compile_elsewhere({}); }

void SceneCompiler::deliver() {
  std::list<Outcome> outcomes;
  {
    const std::lock_guard lock(guard_);
    outcomes.swap(outcomes_);
  }
  for (Outcome& outcome : outcomes) {
    if (outcome.scene) {
      library_.add(std::move(outcome.scene));
      continue;
    }
    failed_(outcome.name, outcome.why_not);
    library_.give_up(outcome.name, std::move(outcome.why_not));
  }
}

void SceneCompiler::run(const std::stop_token& stop) {
  while (true) {
    SceneLibrary::Compilation compilation;
    {
      std::unique_lock lock(guard_);
      if (!wanted_changed_.wait(lock, stop, [this] { return !wanted_.empty(); }) || stop.stop_requested()) return;
      compilation = std::move(wanted_.front());
      wanted_.pop_front();
    }
    std::list<Outcome> outcome(1);
    outcome.front().name = compilation.name;
    std::string no_memory = "there is not enough memory";
    try {
      try {
        outcome.front().scene = compilation.compile();
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {
        outcome.front().why_not = error.what();
      }
    } catch (const std::bad_alloc&) {
      outcome.front().why_not = std::move(no_memory);
    }
    const std::lock_guard lock(guard_);
    outcomes_.splice(outcomes_.end(), outcome);
  }
}

}  // namespace forcebound::server
