#include <sstream>

#include "forcebound/client/commands/replay/csv_reader.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_csv(Bytes bytes) {
  may_refuse([&] {
    std::istringstream text{std::string(text_of(bytes))};
    client::commands::CsvReader reader(text, "table.csv");
    const std::vector<std::string> columns = reader.header();
    while (!reader.row(columns).empty()) {
    }
  });
}

}  // namespace forcebound::fuzz
