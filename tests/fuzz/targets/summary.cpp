#include "forcebound/results/runs_table.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_summary(Bytes bytes) {
  static InputFile file("run.json");
  file.replace(bytes);
  may_refuse([&] { (void)results::comparison_table({{file.path(), results::read_summary(file.path())}}); });
}

}  // namespace forcebound::fuzz
