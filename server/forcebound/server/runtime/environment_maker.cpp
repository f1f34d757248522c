#include "forcebound/server/runtime/environment_maker.hpp"

#include <exception>
#include <new>
#include <utility>

namespace forcebound::server {

EnvironmentMaker::EnvironmentMaker(EnvironmentLibrary library,
                                   std::function<void(std::string_view name, std::string_view why)> failed)
    : library_(std::move(library)),
      failed_(std::move(failed)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {
  library_.make_elsewhere([this](EnvironmentLibrary::Later later) {
    {
      const std::lock_guard lock(guard_);
      wanted_.push_back(std::move(later));
    }
    wanted_changed_.notify_one();
  });
}

EnvironmentMaker::~EnvironmentMaker() { library_.make_elsewhere({}); }

void EnvironmentMaker::deliver() {
  std::list<Outcome> outcomes;
  {
    const std::lock_guard lock(guard_);
    outcomes.swap(outcomes_);
  }
  for (Outcome& outcome : outcomes) {
    if (outcome.made) {
      library_.store(outcome.name, *std::move(outcome.made));
      continue;
    }
    failed_(outcome.name, outcome.why_not);
    library_.give_up(outcome.name, std::move(outcome.why_not));
  }
}

void EnvironmentMaker::run(const std::stop_token& stop) {
  while (true) {
    EnvironmentLibrary::Later later;
    {
      std::unique_lock lock(guard_);
      if (!wanted_changed_.wait(lock, stop, [this] { return !wanted_.empty(); }) || stop.stop_requested()) return;
      later = std::move(wanted_.front());
      wanted_.pop_front();
    }
    std::list<Outcome> outcome(1);
    outcome.front().name = later.name;
    std::string no_memory = "there is not enough memory";
    try {
      try {
        outcome.front().made = later.make();
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
