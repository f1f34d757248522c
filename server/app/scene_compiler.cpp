#include "forcebound/server/app/scene_compiler.hpp"

#include <spdlog/spdlog.h>

#include <exception>
#include <utility>

namespace forcebound::server {

SceneCompiler::SceneCompiler(SceneLibrary library)
    : library_(std::move(library)), thread_([this](const std::stop_token& stop) { run(stop); }) {
  library_.compile_elsewhere([this](SceneLibrary::Compilation compilation) {
    {
      const std::lock_guard lock(guard_);
      wanted_.push_back(std::move(compilation));
    }
    wanted_changed_.notify_one();
  });
}

void SceneCompiler::deliver() {
  std::vector<std::shared_ptr<const Scene>> compiled;
  {
    const std::lock_guard lock(guard_);
    compiled.swap(compiled_);
  }
  for (auto& scene : compiled) library_.add(std::move(scene));
}

void SceneCompiler::run(const std::stop_token& stop) {
  while (true) {
    SceneLibrary::Compilation compile;
    {
      std::unique_lock lock(guard_);
      if (!wanted_changed_.wait(lock, stop, [this] { return !wanted_.empty(); })) return;
      compile = std::move(wanted_.front());
      wanted_.pop_front();
    }
    try {
      auto scene = compile();
      const std::lock_guard lock(guard_);
      compiled_.push_back(std::move(scene));
    } catch (const std::exception& error) {
      spdlog::error("a scene that a client asked for cannot be had: {}", error.what());
    }
  }
}

}  // namespace forcebound::server
