#include <sstream>

#include "tests/fuzz/input.hpp"
#include "tests/tools/lab/csv_reader.hpp"

namespace forcebound::fuzz {

void fuzz_csv(Bytes bytes) {
  may_refuse([&] {
    std::istringstream text{std::string(text_of(bytes))};
    lab::CsvReader reader(text, "table.csv");
    const std::vector<std::string> columns = reader.header();
    while (!reader.row(columns).empty()) {
    }
  });
}

}  // namespace forcebound::fuzz
