#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "forcebound/client/rendering/scene_cache.hpp"
#include "forcebound/client/rendering/scene_exchange.hpp"
#include "forcebound/handover/scene_assembly.hpp"

namespace forcebound::client {

/// Counts of what servers handed over.
struct HandoverCounts {
  std::uint64_t pieces = 0;      ///< put together
  std::uint64_t bytes = 0;       ///< of them
  std::uint64_t from_cache = 0;  ///< scenes that were in the cache
  std::uint64_t scenes_built = 0;
  std::uint64_t refused = 0;    ///< offers that contradicted themselves or exceeded a limit
  std::string why_refused{};    ///< the last one, in one line
  std::string cache_problem{};  ///< empty: none
};

/// Makes scenes of the pieces that arrive, beside the tick: reads the cache, verifies, builds the shapes of the pieces
/// so far, and hands the scene to the tick. Allocates, does I/O and takes unbounded time: in a program it has a thread
/// of its own, in a simulation it works between the ticks.
class SceneBuilder {
 public:
  struct Options {
    std::uint32_t degrees_of_freedom = 3;  ///< of the device
    std::string cache_folder{};            ///< empty: nothing is kept
    handover::Limits limits{};
    scene::Registry registry = scene::Registry::standard();  ///< shapes and effects that can run here
  };

  SceneBuilder(Options options, SceneExchange& exchange);

  /// All that waits to be done. How much was built, in triangles and heights: what that takes is in proportion to it.
  /// @param ended what is being built is given up, uncounted, and nothing more is begun: it waits for the disk no
  /// longer than one file takes
  std::size_t work(const std::stop_token& ended = {});

  /// As they are, whatever thread works. Waits and allocates: not for the tick.
  [[nodiscard]] HandoverCounts counts() const;

  /// The newest scene built, to be looked at; null: there is none. Waits: not for the tick.
  [[nodiscard]] std::shared_ptr<const scene::Scene> newest() const;

  /// While the exchange's phase is `refused`: what cannot be, in one line. For the tick, which ordered what was
  /// refused: until its next order nothing writes here.
  [[nodiscard]] std::string_view why_refused() const noexcept { return why_refused_; }

 private:
  void begin(const BuildOrder& order, const std::stop_token& ended);
  void add_piece(const BuildOrder& order);
  void refuse(const std::string& why);
  [[nodiscard]] std::optional<handover::SceneAssembly> from_cache(const handover::Announcement& announcement,
                                                                  const std::stop_token& ended);
  [[nodiscard]] bool worth_building() const;
  std::size_t build(const std::stop_token& ended);
  void show(std::shared_ptr<const scene::Scene> scene);
  template <class Change>
  void count(Change change);
  void store_cache_problem();

  Options options_;
  SceneExchange& exchange_;
  SceneCache cache_;
  std::optional<handover::SceneAssembly> assembly_;
  std::uint64_t generation_ = 0;
  std::uint64_t number_ = 0;               // of the scene built last
  std::size_t pieces_built_ = 0;           // of the assembly, into that scene
  std::size_t pieces_in_builds_ = 0;       // of all scenes built of it
  std::size_t coarse_levels_built_ = 0;    // in that scene
  std::vector<handover::Coverage> exact_;  // of that scene
  bool stored_ = false;
  std::string why_refused_;
  mutable std::mutex counting_;
  HandoverCounts counts_;                       // behind `counting_`
  std::shared_ptr<const scene::Scene> newest_;  // likewise
};

}  // namespace forcebound::client
