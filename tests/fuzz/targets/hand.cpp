#include "forcebound/device/simulated/replay_operator.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_hand(Bytes bytes) {
  for (const int dof : {1, 3}) {
    may_refuse([&] {
      auto motion = device::parse_motion(text_of(bytes), "hand.csv", dof);
      must(motion.size() >= 2, "a motion of less than two rows");
      const device::ReplayOperator hand(device::OperatorSettings("replay:hand.csv", ""), dof, std::move(motion));
      for (const double time_s : {0.0, 0.1, 1e3}) (void)hand.target(time_s);
    });
  }
}

}  // namespace forcebound::fuzz
