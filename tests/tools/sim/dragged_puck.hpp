#pragma once

#include <string>

namespace forcebound::sim {

/// What a body's scene says of a puck of 0.1 kg that the device drags, weightless.
/// @param stop whether a floor stands still 20 mm below its centre
[[nodiscard]] inline std::string dragged_puck(bool stop) {
  const std::string floor = stop ? R"(<geom type="box" pos="0 0 -0.07" size="0.2 0.2 0.05" solref="0.004 1"/>)" : "";
  return R"(
[[body]]
name = 'puck'
probes = ['puck']
stiffness_N_per_m = 600
damping_N_s_per_m = 4
mjcf_text = '''
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>)" +
         floor + R"(
    <body name="puck">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.02" mass="0.1" solref="0.004 1"/>
    </body>
  </worldbody>
</mujoco>
'''
)";
}

}  // namespace forcebound::sim
