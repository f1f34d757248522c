#pragma once

#include "forcebound/scene/part.hpp"

namespace forcebound::scene {

/// A dynamic model that a client can run by itself, as an object: its force follows from the path of one device alone,
/// and from nothing that anybody else does. In a scene that clients share it is not handed over.
class RunsAtClient {
 public:
  virtual ~RunsAtClient() = default;

  /// Whether it takes no more than a client gives.
  [[nodiscard]] virtual bool fits_client() const noexcept = 0;

  /// The object, of shapes and effects that every client makes of what it is handed (handover). Only where it fits.
  /// Allocates, as much as its geometry.
  [[nodiscard]] virtual PartDescription part_at_client() const = 0;
};

}  // namespace forcebound::scene
