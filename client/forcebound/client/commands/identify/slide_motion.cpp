#include "forcebound/client/commands/identify/slide_motion.hpp"

#include <cmath>
#include <limits>

namespace forcebound::client::commands::identify {
namespace {

constexpr double kWindow_s = 0.12;     // on each side of the release: the farther, the more a joint may differ there
constexpr double kSlowest = 0.1;       // of the speed at the release: slower motion is mostly rounding
constexpr std::size_t kSideLeast = 3;  // samples

}  // namespace

Response response(double s, double rate) noexcept {
  const double z = rate * s;
  if (std::abs(z) < 1e-3) {
    return {.decay = std::exp(-z),
            .phi = s * (1 - z / 2 * (1 - z / 3 * (1 - z / 4))),
            .psi = s * s / 2 * (1 - z / 3 * (1 - z / 4 * (1 - z / 5)))};
  }
  const double phi = -std::expm1(-z) / rate;
  return {.decay = std::exp(-z), .phi = phi, .psi = (s - phi) / rate};
}

double stopped_s(double speed, double slowing, double rate) noexcept {
  if (!(slowing > 0)) return std::numeric_limits<double>::infinity();
  if (!(speed > 0)) return 0;
  const double share = speed / slowing;
  return std::abs(rate * share) < 1e-6 ? share
         : rate * share > -1           ? std::log1p(rate * share) / rate
                                       : std::numeric_limits<double>::infinity();
}

double speed_between(const Slide& slide, std::size_t from, std::size_t to) noexcept {
  const auto& s = slide.samples;
  return (s[to].progress - s[from].progress) / (s[to].latched_s - s[from].latched_s);
}

Part part_of(const Slide& slide) noexcept {
  const auto& s = slide.samples;
  constexpr std::size_t kApart = 4;
  if (slide.still_pushed || slide.released < kApart + 1 || s.size() < slide.released + kSideLeast) return {};
  const double speed = speed_between(slide, slide.released - kApart, slide.released);
  if (!(speed > 0)) return {};
  Part part{slide.released, slide.released};
  bool slow = false;  // there, by its readings
  while (part.begin > 0) {
    const std::size_t next = part.begin - 1;
    if (s[slide.released].latched_s - s[next].latched_s > kWindow_s) break;
    // The force must have been the same, from a latency before on.
    if (next < kApart || s[next - kApart].force != slide.push()) break;
    slow = speed_between(slide, next - kApart / 2, next + kApart / 2) < kSlowest * speed;
    if (slow) break;
    part.begin = next;
  }
  // The readings that say so are more often rounded one way than the other, so they are not used.
  if (slow) part.begin += kApart;
  slow = false;
  while (part.end < s.size()) {
    if (s[part.end].latched_s - s[slide.released].latched_s > kWindow_s) break;
    slow = part.end > slide.released + kApart && speed_between(slide, part.end - kApart, part.end) < kSlowest * speed;
    if (slow) break;
    ++part.end;
  }
  if (slow) part.end -= kApart;
  if (part.begin + kSideLeast > slide.released || part.end < slide.released + kSideLeast) return {};
  return part;
}

}  // namespace forcebound::client::commands::identify
