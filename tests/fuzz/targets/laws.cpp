#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/law_file.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_laws(Bytes bytes) {
  static const control::LawRegistry kLaws = baselines::shipped_laws();
  may_refuse(
      [&] { (void)baselines::describe(baselines::parse_law_parameters(text_of(bytes), "laws.toml", "vc", kLaws)); });
}

}  // namespace forcebound::fuzz
