#include "tests/lab/arena/comparison_run.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace forcebound::lab {
namespace {

using Work = std::vector<std::function<void()>>;

/// Does all of it, on every processor; throws what the first that failed threw.
class Crew {
 public:
  explicit Crew(const std::function<void(std::size_t, std::size_t)>& progress) : progress_(progress) {}

  void expect(std::size_t pieces) { all_ += pieces; }

  void work_off(const Work& work) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    {
      std::vector<std::jthread> workers;
      for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
        workers.emplace_back([&] {
          for (std::size_t piece = next++; piece < work.size(); piece = next++) {
            try {
              work[piece]();
            } catch (...) {
              const std::scoped_lock lock(mutex_);
              if (!failure) failure = std::current_exception();
              next = work.size();
            }
            const std::scoped_lock lock(mutex_);
            progress_(++done_, all_);
          }
        });
      }
    }
    if (failure) std::rethrow_exception(failure);
  }

 private:
  const std::function<void(std::size_t, std::size_t)>& progress_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::size_t all_ = 0;
};

std::vector<Contest> tuning_contests(const ArenaSettings& settings, const Ground& ground) {
  std::vector<Contest> contests;
  const Contest middle{.ground = ground,
                       .stiffness_N_per_m = settings.stiffnesses_N_per_m[settings.stiffnesses_N_per_m.size() / 2],
                       .network = settings.networks.front(),
                       .seed = settings.seed};
  contests.push_back(middle);
  contests.push_back(middle);
  contests.back().network = settings.networks[settings.networks.size() / 2];
  return contests;
}

/// Every contest of a law, without its parameters.
std::vector<PlayedBout> contests_of(const ArenaSettings& settings, const std::string& law) {
  std::vector<PlayedBout> contests;
  for (const Ground& ground : settings.grounds) {
    for (std::size_t network = 0; network < settings.networks.size(); ++network) {
      for (const double stiffness : settings.stiffnesses_N_per_m) {
        for (const Conditions conditions : {Conditions::ideal, Conditions::real}) {
          for (std::uint64_t seed = settings.seed; seed < settings.seed + settings.seeds; ++seed) {
            contests.push_back({.contest = {.ground = ground,
                                            .stiffness_N_per_m = stiffness,
                                            .network = settings.networks[network],
                                            .conditions = conditions,
                                            .law = law,
                                            .seed = seed},
                                .network = network,
                                .bout = {}});
          }
        }
      }
    }
  }
  return contests;
}

const Tuning& tuning_on(const LawInArena& law, const std::string& scene) {
  const auto found = std::ranges::find(law.tuned, scene, &TunedOn::scene);
  return found->tuning;
}

/// The limit is looked for on the wall; a law's parameters there, or its standard ones.
StableStiffness limit_of(const LawInArena& law, const PressingHand& hand, double delay_s) {
  PressedWall wall{.law = law.law, .hand = hand.specification, .delay_s = delay_s};
  const auto tuned = std::ranges::find(law.tuned, std::string("wall"), &TunedOn::scene);
  if (tuned != law.tuned.end()) wall.parameters = tuned->tuning.best;
  return largest_stable({}, [&](double stiffness) { return is_stable(wall, stiffness); });
}

}  // namespace

ArenaResult play_all(const ArenaSettings& settings, const time::Clock& clock,
                     const std::function<void(std::size_t, std::size_t)>& progress) {
  ArenaResult result{.settings = settings};
  Work tuning;
  Work bouts;
  for (const std::string& law : settings.laws) {
    result.laws.push_back({.law = law, .bouts = contests_of(settings, law)});
    for (const Ground& ground : settings.grounds) result.laws.back().tuned.push_back({.scene = ground.scene});
    result.laws.back().stable.resize(settings.delays_s.size(), std::vector<StableStiffness>(pressing_hands().size()));
  }
  for (LawInArena& law : result.laws) {
    for (std::size_t i = 0; i < settings.grounds.size(); ++i) {
      tuning.emplace_back([&, i] {
        law.tuned[i].tuning =
            tune(law.law, tuning_contests(settings, settings.grounds[i]), settings.effort, settings.seed);
      });
    }
    for (PlayedBout& played : law.bouts) {
      bouts.emplace_back([&] {
        played.contest.parameters = tuning_on(law, played.contest.ground.scene).best;
        played.bout = play(played.contest);
      });
    }
    for (std::size_t i = 0; i < settings.delays_s.size(); ++i) {
      for (std::size_t hand = 0; hand < pressing_hands().size(); ++hand) {
        bouts.emplace_back(
            [&, i, hand] { law.stable[i][hand] = limit_of(law, pressing_hands()[hand], settings.delays_s[i]); });
      }
    }
  }
  Crew crew(progress);
  crew.expect(tuning.size() + bouts.size());
  crew.work_off(tuning);
  crew.work_off(bouts);
  for (const double delay_s : settings.delays_s) result.theory.push_back(theory_limits("wall-1dof", delay_s));
  // Alone on the machine, or the laws' work would be the other's as well.
  for (LawInArena& law : result.laws) {
    const Contest& first = law.bouts.front().contest;
    law.work_ns = law.bouts.front().bout.refused.empty() ? work_ns(first, clock) : 0;
  }
  return result;
}

}  // namespace forcebound::lab
