#include "forcebound/client/rendering/scene_builder.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <utility>

namespace forcebound::client {
namespace {

// Each build makes the trees of all that has arrived. So a scene is built again when twice as much is there, and when
// all is or a coarse level. What is near the device does not wait for that: within 20 mm of it, a surface known further
// by a quarter and by a millimetre is built at once, as long as all builds together are of no more than eight times the
// pieces that are there, and some.
constexpr double kNear_m = 0.02;
constexpr double kGain_m = 1e-3;
constexpr double kGain = 0.25;
constexpr std::size_t kGrowth = 2;
constexpr std::size_t kBuiltPerPiece = 8;
constexpr std::size_t kBuiltAtFirst = 256;

}  // namespace

SceneBuilder::SceneBuilder(Options options, SceneExchange& exchange)
    : options_(std::move(options)), exchange_(exchange), cache_(options_.cache_folder) {}

HandoverCounts SceneBuilder::counts() const {
  const std::scoped_lock lock(counting_);
  return counts_;
}

std::shared_ptr<const scene::Scene> SceneBuilder::newest() const {
  const std::scoped_lock lock(counting_);
  return newest_;
}

void SceneBuilder::show(std::shared_ptr<const scene::Scene> scene) {
  const std::scoped_lock lock(counting_);
  newest_ = std::move(scene);
}

template <class Change>
void SceneBuilder::count(Change change) {
  const std::scoped_lock lock(counting_);
  change(counts_);
}

void SceneBuilder::store_cache_problem() {
  count([this](HandoverCounts& counts) { counts.cache_problem = cache_.problem(); });
}

std::size_t SceneBuilder::work(const std::stop_token& ended) {
  exchange_.destroy_used();
  while (!ended.stop_requested()) {
    const auto order = exchange_.next_order();
    if (!order) break;
    if (order->kind == BuildOrder::Kind::begin) {
      begin(*order, ended);
    } else {
      add_piece(*order);
    }
  }
  return assembly_ && !ended.stop_requested() && worth_building() ? build(ended) : 0;
}

void SceneBuilder::begin(const BuildOrder& order, const std::stop_token& ended) {
  generation_ = order.generation;
  pieces_built_ = 0;
  pieces_in_builds_ = 0;
  coarse_levels_built_ = 0;
  exact_.clear();
  stored_ = false;
  assembly_.reset();
  show(nullptr);
  if (order.announcement.manifest_bytes == 0) return exchange_.set_phase(generation_, BuildPhase::nothing);
  try {
    assembly_ = from_cache(order.announcement, ended);
    if (assembly_) {
      stored_ = true;
      count([](HandoverCounts& counts) { ++counts.from_cache; });
      exchange_.set_phase(generation_, BuildPhase::whole);
      return;
    }
    assembly_.emplace(order.announcement, options_.registry, options_.limits);
    exchange_.set_phase(generation_, BuildPhase::wanting);
  } catch (const std::exception& error) {
    refuse(error.what());
  }
}

std::optional<handover::SceneAssembly> SceneBuilder::from_cache(const handover::Announcement& announcement,
                                                                const std::stop_token& ended) {
  const auto content = cache_.load(announcement.hash, ended);
  if (!content || ended.stop_requested()) return std::nullopt;
  // A file that was cut or changed shows by its hashes. What the server sends then takes its place.
  try {
    handover::SceneAssembly assembly(announcement, options_.registry, options_.limits);
    assembly.add_content(*content);
    return assembly;
  } catch (const std::exception&) {
    cache_.store_mismatch(announcement.hash);
    store_cache_problem();
    return std::nullopt;
  }
}

void SceneBuilder::add_piece(const BuildOrder& order) {
  if (!assembly_ || order.generation != generation_) return;
  try {
    const std::size_t before = assembly_->pieces_here();
    if (order.bytes > order.content.size()) {
      throw handover::HandoverError("piece " + std::to_string(order.number) + " is " + std::to_string(order.bytes) +
                                    " bytes long, more than " + std::to_string(order.content.size()));
    }
    assembly_->add(order.number, std::span(order.content).first(order.bytes));
    if (assembly_->pieces_here() == before) return;
    count([&order](HandoverCounts& counts) {
      ++counts.pieces;
      counts.bytes += order.bytes;
    });
  } catch (const std::exception& error) {
    refuse(error.what());
  }
}

/// Whatever a server sends, also what leaves no memory, ends here: held forces instead.
void SceneBuilder::refuse(const std::string& why) {
  assembly_.reset();
  count([&why](HandoverCounts& counts) {
    ++counts.refused;
    counts.why_refused = why;
  });
  why_refused_ = why;
  exchange_.set_phase(generation_, BuildPhase::refused);
}

bool SceneBuilder::worth_building() const {
  const std::size_t here = assembly_->pieces_here();
  if (!assembly_->can_build() || here == pieces_built_) return false;
  if (pieces_built_ == 0 || assembly_->whole() || here >= kGrowth * pieces_built_ ||
      assembly_->coarse_levels_here() > coarse_levels_built_) {
    return true;
  }
  if (pieces_in_builds_ + here > kBuiltPerPiece * here + kBuiltAtFirst) return false;
  const scene::Point place_m = exchange_.place_m();
  double known_m = std::numeric_limits<double>::infinity();
  double slack_m = 0;
  for (const handover::Coverage& coverage : exact_) {
    known_m = std::min(known_m, coverage.known_within_m(place_m));
    slack_m = std::max(slack_m, coverage.slack_m());
  }
  if (!(known_m < kNear_m)) return false;
  return assembly_->known_within_m(place_m) > known_m + slack_m + std::max(kGain_m, kGain * known_m);
}

std::size_t SceneBuilder::build(const std::stop_token& ended) {
  try {
    handover::AssembledScene made = assembly_->build(ended);
    if (!made.scene->accepts(options_.degrees_of_freedom))
      throw handover::HandoverError("the scene is for devices of other degrees of freedom");
    const std::size_t built = made.elements_built;
    pieces_built_ = assembly_->pieces_here();
    pieces_in_builds_ += pieces_built_;
    coarse_levels_built_ = assembly_->coarse_levels_here();
    exact_ = made.exact;
    scene::SceneState state(made.scene, options_.degrees_of_freedom);
    show(made.scene);
    exchange_.publish(
        std::make_unique<BuiltScene>(BuiltScene{generation_, ++number_, std::move(made), std::move(state)}));
    count([](HandoverCounts& counts) { ++counts.scenes_built; });
    if (!assembly_->whole()) return built;
    exchange_.set_phase(generation_, BuildPhase::whole);
    if (!std::exchange(stored_, true)) cache_.store(assembly_->announcement().hash, assembly_->content(), ended);
    store_cache_problem();
    return built;
  } catch (const std::exception& error) {
    if (!ended.stop_requested()) refuse(error.what());
    return 0;
  }
}

}  // namespace forcebound::client
