#include "library/source/facts.hpp"

#include <cstddef>
#include <memory>
#include <string>

#include "forcebound/text/file.hpp"
#include "library/source/errors.hpp"
#include "library/source/structs.hpp"

namespace {

using forcebound::device::RealDevice;
using forcebound::library::guarded;
using forcebound::library::refused;

RealDevice load(const std::string& name_or_path) {
  namespace device = forcebound::device;
  if (device::names_a_file(name_or_path)) {
    return device::parse_facts(forcebound::text::read_file(name_or_path), name_or_path);
  }
  const device::DeviceDescription shipped = device::load_device(name_or_path);
  return {.facts = shipped.facts, .safety = shipped.safety, .identified = shipped.identified};
}

}  // namespace

fb_status fb_facts_load(const char* name_or_path, fb_facts** facts) {
  if (name_or_path == nullptr || facts == nullptr) return refused("fb_facts_load", "an argument is null");
  return guarded("fb_facts_load", [&] {
    *facts = std::make_unique<fb_facts>(fb_facts{load(name_or_path)}).release();
    return FB_OK;
  });
}

fb_status fb_facts_parse(const char* toml, const char* name, fb_facts** facts) {
  if (toml == nullptr || name == nullptr || facts == nullptr) return refused("fb_facts_parse", "an argument is null");
  return guarded("fb_facts_parse", [&] {
    *facts = std::make_unique<fb_facts>(fb_facts{forcebound::device::parse_facts(toml, name)}).release();
    return FB_OK;
  });
}

void fb_facts_destroy(fb_facts* facts) { delete facts; }

fb_status fb_facts_describe(const fb_facts* facts, fb_facts_info* info) {
  if (facts == nullptr) return refused("fb_facts_describe", "facts is null");
  const forcebound::control::DeviceFacts& known = facts->device.facts;
  fb_facts_info described{};
  forcebound::library::set_text(described.name, known.name);
  described.axes = known.degrees_of_freedom();
  described.rotations = known.rotations;
  described.joints = known.joints();
  described.cartesian = known.cartesian ? 1 : 0;
  described.identified = facts->device.identified ? 1 : 0;
  described.period_s = known.period_s;
  described.force_N_max = known.force_N_max;
  described.torque_N_m_max = known.torque_N_m_max;
  described.latency_s = known.latency_s;
  described.hold_s_max = known.releases ? known.hold_s_max : 0;
  return forcebound::library::give("fb_facts_describe", "fb_facts_info", described, info,
                                   offsetof(fb_facts_info, period_s));
}
