#pragma once

#include <string>
#include <vector>

#include "forcebound/server/effects/registry.hpp"
#include "forcebound/server/scene/checked_table.hpp"
#include "forcebound/server/scene/plan.hpp"

namespace forcebound::server {

/// Reads an [[object]] or a [[field]] with the effects that are registered. All members @throw SceneError.
class PartParser {
 public:
  /// @param registry must outlive this
  /// @param rows of points
  PartParser(std::string file, const EffectRegistry& registry, Eigen::Index rows)
      : file_(std::move(file)), registry_(registry), rows_(rows) {}

  [[nodiscard]] SceneObject object(const toml::table& table) const { return part(table, "object"); }
  [[nodiscard]] SceneObject field(const toml::table& table) const { return part(table, "field"); }

 private:
  using Already = std::vector<RequestedEffect>;

  [[nodiscard]] SceneObject part(const toml::table& table, const std::string& what) const;
  [[nodiscard]] std::vector<std::string> names_of_effects(bool of_surfaces_too) const;
  void parse_shape_of(CheckedTable& object, SceneObject& made) const;
  [[nodiscard]] RequestedEffect parse_effect(CheckedTable& part, const toml::node& wanted,
                                             const std::vector<std::string>& known, const Already& already) const;
  [[nodiscard]] EffectValues parse_values(CheckedTable& table, const EffectKind& kind) const;
  [[nodiscard]] Point parse_point(CheckedTable& table, const PointParameter& parameter) const;
  static void refuse_pressure_of_nothing(const CheckedTable& object, const toml::node& effects, const Already& made);
  void refuse_unrequested_tables(const CheckedTable& part, const toml::table& table, const Already& effects) const;

  std::string file_;
  const EffectRegistry& registry_;
  Eigen::Index rows_;
};

}  // namespace forcebound::server
