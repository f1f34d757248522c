#include "forcebound/net/name_lookup.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <semaphore>
#include <stdexcept>
#include <thread>
#include <utility>

namespace forcebound::net {

struct NameLookup::State {
  State(Endpoint its_endpoint, Resolver its_resolver)
      : endpoint(std::move(its_endpoint)), resolver(std::move(its_resolver)), is_name(!is_numeric(endpoint)) {}

  void look_up_once() {
    try {
      std::vector<Address> addresses = resolver(endpoint);
      if (addresses.empty()) throw std::runtime_error("host '" + endpoint.host + "' has no address");
      const std::scoped_lock lock(mutex);
      found = std::move(addresses);
      problem.clear();
      ++generation;
    } catch (const std::runtime_error& error) {
      const std::scoped_lock lock(mutex);
      problem = error.what();
    }
    ++ended;
  }

  void work() noexcept {
    while (true) {
      asked.acquire();
      if (over) return;
      is_asked = false;
      try {
        look_up_once();
      } catch (const std::exception& error) {  // not accepted, or no memory
        const std::scoped_lock lock(mutex);
        problem = error.what();
        ++ended;
      }
      if (ending.try_acquire_for(kPause)) return;
    }
  }

  const Endpoint endpoint;
  const Resolver resolver;
  const bool is_name;
  std::counting_semaphore<> asked{0};
  std::binary_semaphore ending{0};
  std::atomic<bool> is_asked{false};
  std::atomic<bool> over{false};
  std::atomic<std::uint64_t> generation{0};
  std::atomic<std::uint64_t> ended{0};
  mutable std::mutex mutex;
  std::vector<Address> found{};
  std::string problem{};
};

NameLookup::NameLookup(Endpoint endpoint, Resolver resolver)
    : state_(std::make_shared<State>(std::move(endpoint), std::move(resolver))) {
  state_->look_up_once();
  // Not joined at the end: nobody can end a lookup under way, and it may take longer than anybody would wait.
  if (state_->is_name) std::thread([state = state_] { state->work(); }).detach();
}

NameLookup::~NameLookup() {
  state_->over = true;
  state_->ending.release();
  state_->asked.release();
}

void NameLookup::ask() noexcept {
  if (state_->is_name && !state_->is_asked.exchange(true)) state_->asked.release();
}

bool NameLookup::update_turns(std::uint64_t& seen, AddressTurns& turns, time::Nanoseconds now) const noexcept {
  if (state_->generation == seen) return false;
  const std::unique_lock lock(state_->mutex, std::try_to_lock);
  if (!lock) return false;
  seen = state_->generation;
  turns.set(state_->found, now);
  return true;
}

const Endpoint& NameLookup::endpoint() const noexcept { return state_->endpoint; }
bool NameLookup::is_name() const noexcept { return state_->is_name; }
std::uint64_t NameLookup::ended() const noexcept { return state_->ended; }

std::vector<Address> NameLookup::addresses() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->found;
}

std::string NameLookup::problem() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->problem;
}

std::string NameLookup::in_words() const {
  const std::string name = to_string(state_->endpoint);
  const std::scoped_lock lock(state_->mutex);
  if (state_->found.empty()) return name + " (" + state_->problem + ")";
  if (!state_->is_name) return name;
  std::string all;
  for (const Address& address : state_->found) all += (all.empty() ? "" : ", ") + to_string(address);
  return name + " (at " + all + ")";
}

}  // namespace forcebound::net
