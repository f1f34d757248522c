#pragma once

#include "forcebound/client/commands/identify/guide.hpp"

namespace CLI {
class App;
}

namespace forcebound::client::commands::identify {

/// How a device is moved, and how sure its bounds are to be.
struct GuideOptions {
  GuideSettings guide{};
  double confidence = 0.99;  ///< that all bounds hold, together
};

/// --force-share, --speed, --radius, --confidence and --seed. @param seeded what the seed is of
void add_guide_options(CLI::App& command, GuideOptions& options, const char* seeded);

}  // namespace forcebound::client::commands::identify
