#pragma once

#include <memory>
#include <optional>
#include <string>

#include "forcebound/client/app/options.hpp"
#include "forcebound/client/page/live_page.hpp"
#include "forcebound/client/page/page_state.hpp"
#include "forcebound/client/page/tick_tap.hpp"
#include "forcebound/client/runtime/client.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"
#include "forcebound/device/haptic_device.hpp"

namespace forcebound::client {

/// What one client of a run is made of, but for itself.
struct LiveTrack {
  std::unique_ptr<device::HapticDevice> device;
  std::unique_ptr<control::PassivityLaw> law;
  std::shared_ptr<TickTap> tap;
  std::shared_ptr<ViewTap> view;
  std::shared_ptr<device::PointerTarget> pointer{};  ///< null: the hand follows none
  Client::Settings settings;

  /// Where the tip of a simulated device is, not moving any more; nothing of another, and where it touches something:
  /// nobody begins inside.
  [[nodiscard]] std::optional<control::Vector> tip() const;
  [[nodiscard]] ShownTrack shown(time::Nanoseconds epoch) const;
};

/// Makes the clients of a run as they are chosen.
class TrackMaker {
 public:
  /// All must outlive it.
  TrackMaker(const Options& options, const control::LawRegistry& laws, const device::DeviceRegistry& devices)
      : options_(options), laws_(laws), devices_(devices) {}

  /// What the command line says; where the hand is the page's pointer with another law beside, to compare with.
  [[nodiscard]] PageChoice first_choice() const;

  /// A choice whose device suits its scene: the scene's own, if the device is for others, for the server's default
  /// scene that of the command line; a shared scene begins without a law beside; and nothing else is changed.
  /// @throws std::invalid_argument if the device was chosen, and does not suit
  [[nodiscard]] PageChoice suited(PageChoice next, const PageChoice& now) const;

  /// @throws std::exception with one line if the law refuses the device
  void check(const PageChoice& choice) const;

  /// Where the hand begins: where the tip is, if that is the same scene's, else outside of everything.
  void set_start(const PageChoice& choice, const std::optional<control::Vector>& tip);

  /// Where the server says that a hand begins. @returns whether the hand that `set_start` has placed must begin again,
  /// there
  bool set_told_start(const control::Vector& place_m);

  /// @param beside the second client. @param run 1, 2, 3, ...
  [[nodiscard]] std::unique_ptr<LiveTrack> make(const PageChoice& choice, bool beside, int run) const;

  [[nodiscard]] PageState state(const PageChoice& choice, const LiveTrack& main) const;

 private:
  [[nodiscard]] bool has_pointer() const;
  /// By the command line.
  [[nodiscard]] bool has_place() const;
  [[nodiscard]] std::optional<std::string> law_to_compare_with() const;
  [[nodiscard]] std::string hand_of(const PageChoice& choice) const;
  [[nodiscard]] control::DeviceFacts facts_of(const std::string& device) const;
  [[nodiscard]] std::string recording_of(const PageChoice& choice, bool beside, int run) const;

  const Options& options_;
  const control::LawRegistry& laws_;
  const device::DeviceRegistry& devices_;
  control::Vector start_m_;
  std::optional<control::Vector> reported_m_;  ///< of the last scene
  std::string last_scene_;
  bool begins_ = true;  ///< not from where the tip was
  bool first_ = true;
};

/// "law none instead of fba-exact, scene sphere instead of wall".
[[nodiscard]] std::string words_of_change(const PageChoice& before, const PageChoice& after);

/// The file of a run: "run.mcap", "run-2.mcap", "run-3.mcap"; beside: "run-2-beside.mcap".
[[nodiscard]] std::string file_of_run(const std::string& file, int run, bool beside = false);

}  // namespace forcebound::client
