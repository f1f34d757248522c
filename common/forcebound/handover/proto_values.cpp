#include "forcebound/handover/internal/proto_values.hpp"

#include <type_traits>
#include <utility>
#include <variant>

namespace forcebound::handover {

void fill(const config::Values& from, NamedValues* to) {
  for (const auto& [key, value] : from.all()) {
    v1::NamedValue* const named = to->Add();
    named->set_key(key);
    std::visit(
        [named]<class Is>(const Is& is) {
          if constexpr (std::is_same_v<Is, double>) named->set_number(is);
          if constexpr (std::is_same_v<Is, scene::Point>) fill(is, named->mutable_point());
          if constexpr (std::is_same_v<Is, std::string>) named->set_text(is);
          if constexpr (std::is_same_v<Is, bool>) named->set_flag(is);
          if constexpr (std::is_same_v<Is, config::Rows>) {
            v1::Rows* const rows = named->mutable_rows();  // of none as well
            for (const std::vector<double>& row : is) rows->add_row()->mutable_number()->Add(row.begin(), row.end());
          }
        },
        value);
  }
}

config::Values values_of(const NamedValues& from) {
  config::Values values;
  for (const v1::NamedValue& named : from) {
    switch (named.value_case()) {
      case v1::NamedValue::kNumber:
        values.set(named.key(), named.number());
        break;
      case v1::NamedValue::kPoint:
        values.set(named.key(), point_of(named.point()));
        break;
      case v1::NamedValue::kText:
        values.set(named.key(), named.text());
        break;
      case v1::NamedValue::kFlag:
        values.set(named.key(), named.flag());
        break;
      case v1::NamedValue::kRows: {
        config::Rows rows;
        rows.reserve(static_cast<std::size_t>(named.rows().row_size()));
        for (const v1::Row& row : named.rows().row()) rows.emplace_back(row.number().begin(), row.number().end());
        values.set(named.key(), std::move(rows));
        break;
      }
      case v1::NamedValue::VALUE_NOT_SET:
        break;
    }
  }
  return values;
}

}  // namespace forcebound::handover
