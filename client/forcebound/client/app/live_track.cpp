#include "forcebound/client/app/live_track.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/law_file.hpp"
#include "forcebound/client/app/device_in_words.hpp"
#include "forcebound/client/app/run_parts.hpp"
#include "forcebound/client/page/known_scenes.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/device/tick_rate.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::client {
namespace {

constexpr int kSpace = 3;
constexpr std::string_view kPointer = "pointer";
/// If the command line names no file.
constexpr const char* kRecording = "page.mcap";

const device::SimulatedDevice* simulated(const device::HapticDevice& device) {
  return dynamic_cast<const device::SimulatedDevice*>(&device);
}

std::shared_ptr<device::PointerTarget> pointer_of(const device::HapticDevice& device) {
  const device::SimulatedDevice* const with_hand = simulated(device);
  if (with_hand == nullptr) return nullptr;
  const auto* const hand = dynamic_cast<const device::PointerOperator*>(&with_hand->hand());
  return hand == nullptr ? nullptr : hand->pointer();
}

/// How hard a pointer pulls at most, of the largest force of the device, and how far the tip lags then.
constexpr double kPullShare = 0.8;
constexpr double kPull_m = 0.02;
constexpr double kPullMost_m = 0.05;
constexpr double kStiffnessLeast = 50;
constexpr double kStiffnessMost = 400;

/// So stiff that the device holds the pull of the whole way.
double stiffness_for(const control::DeviceFacts& facts) {
  return std::clamp(kPullShare * facts.force_N_max / kPull_m, kStiffnessLeast, kStiffnessMost);
}

/// A specification with another value of a key.
std::string with_key(const std::string& specification, const std::string& key, double value) {
  const std::size_t colon = specification.find(':');
  std::string changed = specification.substr(0, colon) + ":";
  std::string_view rest;
  if (colon != std::string::npos) rest = std::string_view(specification).substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
    if (!item.starts_with(key + "=")) changed += std::string(item) + ",";
  }
  return changed + key + "=" + text::to_text(value);
}

}  // namespace

std::optional<control::Vector> LiveTrack::tip() const {
  const device::SimulatedDevice* const its_device = simulated(*device);
  if (its_device == nullptr || tap->touches()) return std::nullopt;
  return its_device->truth().position;
}

ShownTrack LiveTrack::shown(time::Nanoseconds epoch) const {
  const control::DeviceFacts& facts = device->facts();
  const device::SimulatedDevice* const with_hand = simulated(*device);
  const double stiffness = with_hand == nullptr ? 0 : with_hand->hand().hand().stiffness_N_per_m;
  return {.tap = tap,
          .pointer = pointer,
          .view = view,
          .renders_locally = settings.renders_locally,
          .figures = {.degrees_of_freedom = std::min(facts.translations(), kSpace),
                      .period = time::from_seconds(facts.period_s),
                      .epoch = epoch,
                      .audited = device->audit().has_value(),
                      .scene = settings.scene},
          .pull_m = stiffness > 0 ? std::min(kPullShare * facts.force_N_max / stiffness, kPullMost_m) : kPullMost_m};
}

PageChoice TrackMaker::first_choice() const {
  return {.law = options_.client.law,
          .law_beside = law_to_compare_with(),
          .scene = options_.client.scene,
          .device = options_.device.device,
          .recording = !options_.client.recording.empty()};
}

std::optional<std::string> TrackMaker::law_to_compare_with() const {
  const std::string law = options_.client.law == "none" ? "fba-exact" : "none";
  const KnownScene* const scene = find_known_scene(options_.client.scene);
  const bool shared = scene != nullptr && scene->shared;  // the same hand would be in it twice
  if (!has_pointer() || shared || !laws_.refusal(law, facts_of(options_.device.device)).empty()) return std::nullopt;
  return law;
}

bool TrackMaker::has_place() const { return first_ && options_.device.hand.find("offset_") != std::string::npos; }

bool TrackMaker::has_pointer() const {
  const std::string& hand = options_.device.hand;
  return hand.substr(0, hand.find(':')) == kPointer;
}

control::DeviceFacts TrackMaker::facts_of(const std::string& device) const {
  return device::at_tick_rate(devices_.facts(device), options_.device.rate_Hz);
}

PageChoice TrackMaker::suited(PageChoice next, const PageChoice& now) const {
  if (next.scene.empty() && !now.scene.empty() && next.device == now.device && has_pointer()) {
    // What the server's default needs is not known here; the client was started with a device for it.
    const std::string& started_with = options_.device.device;
    if (facts_of(started_with).translations() != facts_of(next.device).translations()) next.device = started_with;
    return next;
  }
  const KnownScene* const scene = find_known_scene(next.scene);
  if (scene != nullptr && scene->shared && next.scene != now.scene) next.law_beside.reset();
  if (scene == nullptr || scene->accepts(facts_of(next.device).translations())) return next;
  const std::string other = device_for(*scene);
  if (next.device != now.device || !has_pointer()) {
    throw std::invalid_argument("device " + next.device + " has other degrees of freedom than scene " + next.scene +
                                "; accepted is for example " + other);
  }
  next.device = other;
  return next;
}

void TrackMaker::check(const PageChoice& choice) const {
  const control::DeviceFacts facts = facts_of(choice.device);
  std::vector<std::string> laws{choice.law};
  if (choice.law_beside) laws.push_back(*choice.law_beside);
  for (const std::string& law : laws) {
    if (const std::string why = laws_.refusal(law, facts); !why.empty()) throw std::invalid_argument(why);
  }
}

void TrackMaker::set_start(const PageChoice& choice, const std::optional<control::Vector>& tip) {
  const int rows = facts_of(choice.device).translations();
  if (choice.scene != last_scene_) reported_m_.reset();
  begins_ = !tip || tip->rows() != rows || !tip->allFinite() || choice.scene != last_scene_;
  start_m_ = begins_ ? start_in(find_known_scene(choice.scene), rows) : *tip;
  if (begins_ && reported_m_) (void)set_told_start(*reported_m_);
  // A pointer that the command line places begins there.
  first_ = last_scene_.empty() && !tip;
  last_scene_ = choice.scene;
}

bool TrackMaker::set_told_start(const control::Vector& place_m) {
  constexpr double kSame_m = 1e-3;
  reported_m_ = place_m;
  if (!begins_ || !has_pointer() || has_place()) return false;
  control::Vector start_m = control::Vector::Zero(start_m_.rows());
  const Eigen::Index axes = std::min(start_m.rows(), place_m.rows());
  start_m.head(axes) = place_m.head(axes);
  if ((start_m - start_m_).norm() < kSame_m) return false;
  start_m_ = start_m;
  return true;
}

std::string TrackMaker::hand_of(const PageChoice& choice) const {
  std::string hand = options_.device.hand;
  if (choice.stiffness_N_per_m) {
    hand = with_key(hand, "stiffness_N_per_m", *choice.stiffness_N_per_m);
  } else if (has_pointer() && hand.find("stiffness_N_per_m=") == std::string::npos) {
    hand = with_key(hand, "stiffness_N_per_m", stiffness_for(facts_of(choice.device)));
  }
  if (!has_pointer() || has_place()) return hand;
  constexpr std::string_view kAxes = "xyzuvw";
  for (Eigen::Index i = 0; i < start_m_.rows(); ++i) {
    hand = with_key(hand, std::string("offset_") + kAxes[static_cast<std::size_t>(i)] + "_m", start_m_[i]);
  }
  return hand;
}

std::string TrackMaker::recording_of(const PageChoice& choice, bool beside, int run) const {
  if (!choice.recording) return {};
  return file_of_run(options_.client.recording.empty() ? kRecording : options_.client.recording, run, beside);
}

std::unique_ptr<LiveTrack> TrackMaker::make(const PageChoice& choice, bool beside, int run) const {
  auto track = std::make_unique<LiveTrack>();
  device::DeviceRequest request{.device = choice.device, .hand = hand_of(choice), .rate_Hz = options_.device.rate_Hz};
  track->device = devices_.make(request);
  const control::DeviceFacts& facts = track->device->facts();
  const std::string& law = beside ? *choice.law_beside : choice.law;
  Options of_law = options_;
  of_law.client.law = law;
  // The command line's parameters are of its own law.
  if (law != options_.client.law) of_law.law_parameters.clear();
  const control::LawOptions chosen = law_options(of_law, laws_);
  track->law = laws_.make(law, facts, chosen);
  track->tap = std::make_shared<TickTap>();
  track->view = std::make_shared<ViewTap>();
  track->pointer = pointer_of(*track->device);
  Client::Settings& settings = track->settings;
  settings = options_.client;
  settings.law = law;
  const control::LawParameters parameters = laws_.parameters(law, facts, chosen.parameters);
  settings.law_parameters = baselines::describe(parameters);
  settings.guarantee = guarantee_with(*track->device, laws_.guarantee(law));
  settings.scene = choice.scene;
  settings.hand = request.hand;
  settings.beside = beside;
  // What is refused can be chosen anew.
  settings.asks_again = true;
  settings.view = track->view.get();
  // The program ends the run.
  settings.duration_s = 0;
  // As if each were another program: a session that ended must not be taken for the next one.
  settings.seed = options_.client.seed + 2 * static_cast<std::uint64_t>(run) + (beside ? 1U : 0U);
  settings.recording = recording_of(choice, beside, run);
  if (!settings.recording.empty()) settings.attachments = recorded_files(request.device, law, parameters);
  return track;
}

PageState TrackMaker::state(const PageChoice& choice, const LiveTrack& main) const {
  const bool is_simulated = main.device->is_simulated();
  PageState state{.choices = {.beside = is_simulated, .stiffness = is_simulated},
                  .choice = choice,
                  .simulated = is_simulated,
                  .pointer = main.pointer != nullptr,
                  .degrees_of_freedom = std::min(main.device->facts().translations(), kSpace),
                  .period_s = main.device->facts().period_s,
                  .recording_file = main.settings.recording};
  for (const std::string& law : laws_.names()) {
    // A person's hand is not for trying what guarantees nothing.
    if (!is_simulated && laws_.guarantee(law).empty()) continue;
    state.choices.laws.push_back({law, std::string(laws_.find(law).summary)});
  }
  for (const KnownScene& scene : known_scenes()) state.choices.scenes.push_back(scene.name);
  if (has_pointer()) state.choices.devices = device::shipped_device_names();
  if (is_simulated) {
    const device::SimulatedDevice* const with_hand = simulated(*main.device);
    if (with_hand != nullptr) state.choice.stiffness_N_per_m = with_hand->hand().hand().stiffness_N_per_m;
  }
  return state;
}

std::string words_of_change(const PageChoice& before, const PageChoice& after) {
  std::string words;
  const auto add = [&words](const std::string& what, const std::string& old_value, const std::string& new_value) {
    if (old_value == new_value) return;
    words += words.empty() ? "" : ", ";
    words += new_value.empty() ? "no " + what : what + " " + new_value;
    if (!old_value.empty()) words += " instead of " + old_value;
  };
  const auto number = [](const std::optional<double>& value) { return value ? text::to_text(*value) : std::string(); };
  add("law", before.law, after.law);
  add("law beside", before.law_beside.value_or(""), after.law_beside.value_or(""));
  const auto scene = [](const std::string& name) { return name.empty() ? std::string("the server's default") : name; };
  add("scene", scene(before.scene), scene(after.scene));
  add("device", before.device, after.device);
  add("the hand's stiffness in N/m", number(before.stiffness_N_per_m), number(after.stiffness_N_per_m));
  add("recording", before.recording ? "on" : "off", after.recording ? "on" : "off");
  return words;
}

std::string file_of_run(const std::string& file, int run, bool beside) {
  if (file.empty() || (run == 1 && !beside)) return file;
  const std::filesystem::path path(file);
  const std::string number = run == 1 ? "" : "-" + std::to_string(run);
  const std::string name = path.stem().string() + number + (beside ? "-beside" : "") + path.extension().string();
  return (path.parent_path() / name).string();
}

}  // namespace forcebound::client
