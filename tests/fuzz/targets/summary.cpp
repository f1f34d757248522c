#include "tests/fuzz/input.hpp"
#include "tests/tools/lab/runs_table.hpp"

namespace forcebound::fuzz {

void fuzz_summary(Bytes bytes) {
  static InputFile file("run.json");
  file.replace(bytes);
  may_refuse([&] { (void)lab::comparison_table({{file.path(), lab::read_summary(file.path())}}); });
}

}  // namespace forcebound::fuzz
